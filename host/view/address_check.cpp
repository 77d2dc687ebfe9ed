#include "host/view/address_check.h"

#include <impactdic/error.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace impactdic::view {

std::string random_token() {
  std::array<unsigned char, 16> bits{};
  if (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size())) {
    throw FileError("the system gives no random numbers", "getrandom");
  }
  std::string token;
  for (const unsigned char byte : bits) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

bool is_own_host(std::string_view host) {
  const std::size_t colon = host.find(':');
  const std::string_view name = host.substr(0, colon);
  if (name != "127.0.0.1" && name != "localhost") return false;
  if (colon == std::string_view::npos) return true;
  const std::string_view port = host.substr(colon + 1);
  return !port.empty() && port.size() <= 5 &&
         std::all_of(port.begin(), port.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool is_own_origin(std::string_view origin) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && is_own_host(origin.substr(kScheme.size()));
}

std::optional<std::string> behind_token(std::string_view path, std::string_view token) {
  if (path.size() < token.size() + 2 || path[0] != '/' || path[token.size() + 1] != '/') {
    return std::nullopt;
  }
  unsigned different = token.empty() ? 1 : 0;
  for (std::size_t i = 0; i < token.size(); ++i) {
    different |= static_cast<unsigned char>(path[i + 1]) ^ static_cast<unsigned char>(token[i]);
  }
  if (different != 0) return std::nullopt;
  return std::string(path.substr(token.size() + 2));
}

}  // namespace impactdic::view
