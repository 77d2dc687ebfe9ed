// What the shared library shows. A public header opens `namespace IMPACTDIC_PUBLIC impactdic {`:
// all that it declares there can be linked and caught across the library's border. The library is
// built with everything else hidden.
#pragma once

#if defined(__GNUC__)
#define IMPACTDIC_PUBLIC [[gnu::visibility("default")]]
// For what a public class names but keeps to itself.
#define IMPACTDIC_PRIVATE [[gnu::visibility("hidden")]]
#else
#define IMPACTDIC_PUBLIC
#define IMPACTDIC_PRIVATE
#endif
