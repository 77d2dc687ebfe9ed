#include "host/base/process/stand_back.h"

#include <sys/resource.h>

namespace impactdic {

void stand_back() {
  constexpr int kNice = 10;  // Linux: its weight is 110 where another thread's is 1024
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, kNice));
}

}  // namespace impactdic
