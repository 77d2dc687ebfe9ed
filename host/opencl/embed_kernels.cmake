# cmake -DOUT=file.cpp -DROOT=repository -P embed_kernels.cmake: every .cl and .h of kernels/ as text.
file(GLOB_RECURSE sources RELATIVE ${ROOT} ${ROOT}/kernels/*.cl ${ROOT}/kernels/*.h)
list(SORT sources)
set(head "#include <map>
#include <string>
#include <string_view>
namespace impactdic::opencl {
const std::map<std::string, std::string_view>& embedded_kernels() {
  static const std::map<std::string, std::string_view> kernels = {
")
file(WRITE ${OUT} "${head}")
foreach(source ${sources})
  file(READ ${ROOT}/${source} content)
  file(APPEND ${OUT} "{\"${source}\", R\"opencl_c(")
  file(APPEND ${OUT} "${content}")
  file(APPEND ${OUT} ")opencl_c\"},\n")
endforeach()
file(APPEND ${OUT} "  };\n  return kernels;\n}\n}  // namespace impactdic::opencl\n")
