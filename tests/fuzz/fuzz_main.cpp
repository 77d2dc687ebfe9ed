// Any bytes as a file that the program reads: each of the readers must give a result or one of the
// library's errors. The environment's FUZZ_KIND says which reader; scripts/fuzz runs them all.
#include <impactdic/error.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "tests/fuzz/fuzz_kind.h"

namespace impactdic::fuzz {

namespace fs = std::filesystem;

const fs::path& scratch() {
  struct Folder {
    fs::path path;
    Folder() {
      std::string name = (fs::temp_directory_path() / "impactdic_fuzz_XXXXXX").string();
      if (::mkdtemp(name.data()) == nullptr) std::abort();
      path = name;
    }
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  };
  static const Folder made;
  return made.path;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

namespace {

const Kind& asked_kind() {
  const char* const name = std::getenv("FUZZ_KIND");
  const auto found = kinds().find(name == nullptr ? "" : name);
  if (found != kinds().end()) return found->second;
  for (const auto& [known, of] : kinds()) std::printf("%s\n", known.c_str());
  std::fflush(stdout);
  std::_Exit(2);  // without the fuzzer's last words
}

}  // namespace
}  // namespace impactdic::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  static const impactdic::fuzz::Kind& tried = impactdic::fuzz::asked_kind();
  const auto path = impactdic::fuzz::scratch() / tried.name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  try {
    tried.read(path);
  } catch (const impactdic::Error&) {
  }
  return 0;
}
