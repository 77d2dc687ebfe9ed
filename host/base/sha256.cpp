#include "host/base/sha256.h"

#include <impactdic/error.h>
#include <openssl/evp.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <memory>
#include <vector>

namespace impactdic {
namespace {

class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) {
      throw Error("SHA-256 is not available in libcrypto");
    }
  }
  void add(const void* bytes, std::size_t count) { EVP_DigestUpdate(context_.get(), bytes, count); }
  std::string hex() {
    unsigned char raw[EVP_MAX_MD_SIZE];
    unsigned length = 0;
    EVP_DigestFinal_ex(context_.get(), raw, &length);
    std::string text;
    for (unsigned i = 0; i < length; ++i) {
      text += "0123456789abcdef"[raw[i] >> 4];
      text += "0123456789abcdef"[raw[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string sha256_of_text(std::string_view bytes) {
  Digest digest;
  digest.add(bytes.data(), bytes.size());
  return digest.hex();
}

std::string sha256_of_file(const std::string& path) {
  return sha256_of_part(path, 0, std::numeric_limits<std::uint64_t>::max());
}

std::string sha256_of_part(const std::string& path, std::uint64_t offset, std::uint64_t count) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError("cannot read the file", path);
  file.seekg(static_cast<std::streamoff>(offset));
  Digest digest;
  std::vector<char> block(1 << 20);
  while (file && count > 0) {
    const std::uint64_t wanted = std::min<std::uint64_t>(block.size(), count);
    file.read(block.data(), static_cast<std::streamsize>(wanted));
    digest.add(block.data(), static_cast<std::size_t>(file.gcount()));
    count -= wanted;
  }
  return digest.hex();
}

}  // namespace impactdic
