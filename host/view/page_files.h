// The files of the page, which are part of the binary.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace impactdic::view {

struct PageFile {
  std::string_view bytes;
  bool gzipped = false;
};

// By name: "index.html", "main.js", "style.css", ... and, where it was there when the program was
// built, "plotly.js".
const std::map<std::string, PageFile>& page_files();

}  // namespace impactdic::view
