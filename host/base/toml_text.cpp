#include "host/base/toml_text.h"

#include <impactdic/error.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace impactdic {
namespace {

// Where the text or comment ends that begins at `at`; the end of all where it does not.
std::size_t end_of_quoted(std::string_view text, std::size_t at) {
  const char quote = text[at];
  if (quote == '#') return text.find('\n', at);
  const bool is_long = text.substr(at, 3) == std::string(3, quote);
  std::size_t i = at + (is_long ? 3 : 1);
  for (; i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (is_long && text.substr(i, 3) == std::string(3, quote)) {
      return i + 3;
    } else if (!is_long && (text[i] == quote || text[i] == '\n')) {
      return i + 1;
    }
  }
  return std::string_view::npos;
}

}  // namespace

void check_toml_nesting(std::string_view text, const std::string& where) {
  int line = 1, open = 0, dots = 0;
  const auto refuse = [&] {
    throw InvalidArgument("keys or values nest deeper than " + std::to_string(kMostTomlLevels),
                          where + ", line " + std::to_string(line), "a job needs three levels");
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    switch (text[i]) {
      case '"':
      case '\'':
      case '#': {
        const std::size_t end = std::min(end_of_quoted(text, i), text.size());
        for (; i < end; ++i) line += text[i] == '\n';
        if (end > 0 && text[end - 1] == '\n') dots = 0;
        --i;
        break;
      }
      case '\n':
        ++line;
        [[fallthrough]];
      case '=':
      case ',':
        dots = 0;
        break;
      case '[':
      case '{':
        ++open;
        break;
      case ']':
      case '}':
        --open;
        break;
      case '.':
        ++dots;
        break;
      default:
        break;
    }
    if (open > kMostTomlLevels || dots > kMostTomlLevels) refuse();
  }
}

std::string read_toml_text(const std::filesystem::path& file) {
  std::error_code error;
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file, error)) {
    throw FileError("cannot read the file", file.string());
  }
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (!error && size > kMostTomlBytes) {
    throw InvalidArgument("a file of " + std::to_string(size) + " bytes", file.string(),
                          "at most " + std::to_string(kMostTomlBytes) + " are read");
  }
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  check_toml_nesting(text, file.string());
  return text;
}

}  // namespace impactdic
