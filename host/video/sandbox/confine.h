// What the process that decodes takes from itself, once its libraries are loaded.
#pragma once

#include <string>
#include <vector>

namespace impactdic::video::sandbox {

// What the kernel knows to take.
struct Confined {
  bool files = false;    // Landlock, of Linux 5.13 and later: no file but the clip's can be opened
  bool network = false;  // a filter of system calls: no socket, program, process, or signal
};

// For good, and for all threads that are started from now on: nothing but the files at `paths` can
// be opened, no socket made, no program or process started, no other process signalled or looked
// into. A kernel that does not know how leaves its part as it was. Where none of `paths` is there
// all files are left as they were, so that its own error is told.
Confined confine(const std::vector<std::string>& paths);

}  // namespace impactdic::video::sandbox
