// A request of the page and its answer, without HTTP.
#pragma once

#include <impactdic/error.h>

#include <cstdint>
#include <map>
#include <string>

namespace impactdic::view {

struct PageRequest {
  bool changes = false;  // POST: it may change something; else GET
  std::string name;      // behind the token, "api/frame"
  std::map<std::string, std::string> query;
  std::string body;

  // "" where the query has no such key.
  std::string text(const std::string& key) const {
    const auto found = query.find(key);
    return found == query.end() ? std::string() : found->second;
  }
};

struct PageAnswer {
  int status = 200;
  std::string type;
  std::string body;
  bool gzipped = false;
};

// What was asked for is not there. Answered by 404.
class NotThere : public Error {
 public:
  using Error::Error;
};

// Another request has taken this one's place. Answered by 409.
class Overtaken : public Error {
 public:
  using Error::Error;
};

}  // namespace impactdic::view
