#include "host/video/codec_module.h"

#include <dlfcn.h>
#include <impactdic/error.h>

#include <string_view>

namespace impactdic::video {
namespace {

struct Loaded {
  const CodecModule* module = nullptr;
  std::string error;
};

Loaded load() {
  void* library = ::dlopen(IMPACTDIC_CODEC_MODULE, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return {nullptr, ::dlerror()};
  void* symbol = ::dlsym(library, "impactdic_codec_module");
  if (symbol == nullptr) return {nullptr, std::string(IMPACTDIC_CODEC_MODULE) + " is not ours"};
  const auto* module = static_cast<const CodecModule*>(symbol);
  if (module->version != std::string_view(IMPACTDIC_VERSION)) {
    return {nullptr, std::string(IMPACTDIC_CODEC_MODULE) + " is of version " + module->version};
  }
  return {module, {}};
}

}  // namespace

bool has_codecs() { return std::string_view(IMPACTDIC_CODEC_MODULE) != ""; }

const CodecModule& codec_module(const std::string& path, const std::string& instead) {
  if (!has_codecs()) throw InvalidArgument("this program was built without codecs", path, instead);
  static const Loaded loaded = load();
  if (loaded.module == nullptr) {
    throw FileError("the codecs cannot be loaded", path, loaded.error);
  }
  return *loaded.module;
}

}  // namespace impactdic::video
