// SHA-256 of bytes and files, as lower-case hexadecimal (OpenSSL's libcrypto).
#pragma once

#include <string>
#include <string_view>

namespace impactdic {

std::string sha256_of_text(std::string_view bytes);
// Reads the file in blocks. Throws FileError where it cannot be read.
std::string sha256_of_file(const std::string& path);

}  // namespace impactdic
