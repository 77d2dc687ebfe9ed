// SHA-256 of bytes and files, as lower-case hexadecimal (OpenSSL's libcrypto).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace impactdic {

std::string sha256_of_text(std::string_view bytes);
// Reads the file in blocks. Throws FileError where it cannot be read.
std::string sha256_of_file(const std::string& path);
// Of `count` bytes from `offset` on; of fewer where the file ends before.
std::string sha256_of_part(const std::string& path, std::uint64_t offset, std::uint64_t count);

}  // namespace impactdic
