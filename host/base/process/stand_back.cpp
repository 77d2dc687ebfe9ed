#include "host/base/process/stand_back.h"

#include <sys/resource.h>

namespace impactdic {

void stand_back() {
  constexpr int kNicer = 10;  // Linux: a weight of 110 where another thread's is 1024
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, ::getpriority(PRIO_PROCESS, 0) + kNicer));
}

}  // namespace impactdic
