// Who may ask: only who has the address that was printed, by the name of this machine alone.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace impactdic::view {

// 128 random bits as 32 hexadecimal digits. Throws FileError where the system gives none.
std::string random_token();

// Whether a Host header names this machine itself: "127.0.0.1" or "localhost", with or without a
// port. Another name that leads here is one that a foreign page has made up (DNS rebinding). The
// port may be another one where ssh forwards it.
bool is_own_host(std::string_view host);

// The same of an Origin header, "http://HOST".
bool is_own_origin(std::string_view origin);

// What a path asks for behind "/TOKEN/"; nullopt where it does not begin with the token. How long
// the comparison takes does not tell how much of the token is right.
std::optional<std::string> behind_token(std::string_view path, std::string_view token);

}  // namespace impactdic::view
