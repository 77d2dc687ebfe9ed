#include <impactdic/version.h>

namespace impactdic {

const char* version() { return IMPACTDIC_VERSION; }

}  // namespace impactdic
