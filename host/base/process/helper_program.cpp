#include "host/base/process/helper_program.h"

#include <dlfcn.h>
#include <link.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <vector>

namespace impactdic {

std::string helper_program(const std::string& name) {
  Dl_info own = {};
  ::dladdr(reinterpret_cast<const void*>(&helper_program), &own);
  // The program itself is not found by its name.
  void* handle = own.dli_fname == nullptr
                     ? nullptr
                     : ::dlopen(own.dli_fname, RTLD_LAZY | RTLD_NOLOAD | RTLD_LOCAL);
  if (handle == nullptr) handle = ::dlopen(nullptr, RTLD_LAZY);
  Dl_serinfo size = {};
  if (handle == nullptr || ::dlinfo(handle, RTLD_DI_SERINFOSIZE, &size) != 0) return "";
  std::vector<std::max_align_t> memory(size.dls_size / sizeof(std::max_align_t) + 1);
  auto* all = reinterpret_cast<Dl_serinfo*>(memory.data());
  std::memcpy(all, &size, sizeof size);
  std::string found;
  if (::dlinfo(handle, RTLD_DI_SERINFO, all) == 0) {
    for (unsigned i = 0; i < all->dls_cnt && found.empty(); ++i) {
      const std::string path = std::string(all->dls_serpath[i].dls_name) + "/" + name;
      if (::access(path.c_str(), X_OK) == 0) found = path;
    }
  }
  ::dlclose(handle);
  return found;
}

void Descriptor::set(int number) {
  close();
  number_ = number;
}

void Descriptor::close() {
  if (number_ >= 0) ::close(number_);
  number_ = -1;
}

}  // namespace impactdic
