// Writing a job as TOML text.
#pragma once

#include <impactdic/impact_model.h>

#include <string>
#include <string_view>
#include <vector>

namespace impactdic::sim::job {

class TomlText {
 public:
  void table(std::string_view name);
  void name(std::string_view key, std::string_view value);
  // In the shortest form that reads back exactly, and as a float.
  void number(std::string_view key, double value);
  void integer(std::string_view key, long value);
  void boolean(std::string_view key, bool value);
  void names(std::string_view key, const std::vector<std::string>& values);
  void numbers(std::string_view key, const std::vector<double>& values);
  // The table [body], or that of another body.
  void body(const ImpactBody& body, std::string_view table_name = "body");

  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

}  // namespace impactdic::sim::job
