// A process as others can tell it, on this machine or another.
#pragma once

#include <string>

namespace impactdic {

struct ProcessName {
  std::string host, start;  // when it began, which tells it from a later one of the same number
  long pid = 0;             // 0: not known
};

ProcessName this_process();

// "host H\npid P\nstart S\n", and back; what is missing there stays empty.
std::string to_text(const ProcessName& process);
ProcessName parse_process(const std::string& text);

// Whether it certainly runs no more: it was one of this machine, and is not there. Of those of
// other machines nothing is known.
bool is_gone(const ProcessName& process);

// Whether it is of this machine and gone, or about to be: killed, but still giving its memory and
// files back, which takes a large process a while. What it had locked is locked until then.
bool is_ending(const ProcessName& process);

}  // namespace impactdic
