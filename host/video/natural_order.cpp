#include "host/video/natural_order.h"

#include <glob.h>
#include <impactdic/error.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "host/video/file_kind.h"

namespace impactdic::video {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Takes the run of digits off the front of `text`.
std::string_view take_digits(std::string_view& text) {
  std::size_t length = 0;
  while (length < text.size() && is_digit(text[length])) ++length;
  const std::string_view run = text.substr(0, length);
  text.remove_prefix(length);
  return run;
}

std::string_view without_zeros(std::string_view digits) {
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

std::string kind_of_extension(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".tiff" ? ".tif" : extension == ".jpeg" ? ".jpg" : extension;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a, whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view x = without_zeros(take_digits(a)), y = without_zeros(take_digits(b));
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a.front() != b.front()) {
        return static_cast<unsigned char>(a.front()) < static_cast<unsigned char>(b.front());
      }
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  if (whole_a.size() != whole_b.size()) return whole_a.size() < whole_b.size();
  return whole_a < whole_b;
}

std::vector<std::string> pictures_in_folder(const std::string& folder) {
  std::vector<std::string> files;
  std::set<std::string> kinds;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string path = entry->path().string();
    if (!has_picture_extension(path) || entry->path().filename().string().front() == '.') continue;
    files.push_back(path);
    kinds.insert(kind_of_extension(path));
  }
  if (error) throw FileError("cannot list the folder", folder, error.message());
  if (files.empty()) {
    throw InvalidArgument("the folder holds no pictures", folder,
                          ".tif .tiff .png .bmp .jpg .jpeg .pgm are looked for");
  }
  if (kinds.size() > 1) {
    throw InvalidArgument("the folder holds pictures of several kinds", folder,
                          "name one kind with a quoted pattern such as \"" +
                              (fs::path(folder) / ("*" + *kinds.begin())).string() + "\"");
  }
  std::sort(files.begin(), files.end(), natural_less);
  return files;
}

bool is_pattern(const std::string& text) { return text.find_first_of("*?[") != std::string::npos; }

std::vector<std::string> files_of_pattern(const std::string& pattern) {
  glob_t found{};
  const int status = ::glob(pattern.c_str(), 0, nullptr, &found);
  std::vector<std::string> files;
  for (std::size_t i = 0; status == 0 && i < found.gl_pathc; ++i) {
    std::error_code error;
    if (!fs::is_directory(found.gl_pathv[i], error)) files.emplace_back(found.gl_pathv[i]);
  }
  ::globfree(&found);
  if (files.empty()) throw FileError("no file matches the pattern", pattern);
  std::sort(files.begin(), files.end(), natural_less);
  return files;
}

}  // namespace impactdic::video
