// What the fuzzers' programs have in common: any bytes as a file, and who reads it.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace impactdic::fuzz {

struct Kind {
  const char* name;  // of the file
  void (*read)(const std::filesystem::path&);
};

// Of one program, by the name that FUZZ_KIND gives.
const std::map<std::string, Kind>& kinds();

// A folder for the files, of this process alone.
const std::filesystem::path& scratch();
std::string text_of(const std::filesystem::path& path);

}  // namespace impactdic::fuzz
