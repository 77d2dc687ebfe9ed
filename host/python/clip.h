// Clips in Python: files, and arrays in memory.
#pragma once

#include <impactdic/clip.h>
#include <nanobind/nanobind.h>

#include <memory>
#include <string>
#include <vector>

namespace impactdic::python {

// What the Python class impactdic.Clip holds.
struct PythonClip {
  std::shared_ptr<FrameSource> source;
  std::vector<std::string> paths;  // of a clip in files; runs open them anew, as the program does
  OpenOptions open;
};

// Names the clip in a request.
void put_into(ClipRequest& request, const PythonClip& clip);

void bind_clip(nanobind::module_& module);

}  // namespace impactdic::python
