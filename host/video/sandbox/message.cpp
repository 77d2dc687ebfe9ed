#include "host/video/sandbox/message.h"

#include <impactdic/error.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace impactdic::video::sandbox {

Message& Message::add(std::int64_t number) {
  bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
  return *this;
}

Message& Message::add(double number) {
  bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
  return *this;
}

Message& Message::add(const std::string& text) {
  add(static_cast<std::int64_t>(text.size()));
  bytes_ += text;
  return *this;
}

std::int64_t Message::number() {
  std::int64_t number = 0;
  if (bytes_.size() - at_ < sizeof number) throw Error("the codecs' process sent too little");
  std::memcpy(&number, bytes_.data() + at_, sizeof number);
  at_ += sizeof number;
  return number;
}

double Message::real() {
  const std::int64_t bits = number();
  double value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

std::string Message::text() {
  const std::int64_t size = number();
  if (size < 0 || static_cast<std::uint64_t>(size) > bytes_.size() - at_) {
    throw Error("the codecs' process sent too little");
  }
  std::string text = bytes_.substr(at_, static_cast<std::size_t>(size));
  at_ += text.size();
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
  }
  return text;
}

bool Message::send(int socket) const {
  ssize_t sent = 0;
  do {
    sent = ::send(socket, bytes_.data(), bytes_.size(), MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(bytes_.size());
}

std::optional<Message> Message::receive(int socket, int longest_ms, bool& late) {
  late = false;
  pollfd look = {socket, POLLIN, 0};
  int ready = 0;
  do {
    ready = ::poll(&look, 1, longest_ms);
  } while (ready < 0 && errno == EINTR);
  if (ready == 0) {
    late = true;
    return std::nullopt;
  }
  std::string bytes(kLongestMessage, '\0');
  ssize_t got = 0;
  do {
    got = ::recv(socket, bytes.data(), bytes.size(), 0);
  } while (got < 0 && errno == EINTR);
  if (got <= 0) return std::nullopt;
  bytes.resize(static_cast<std::size_t>(got));
  return Message(std::move(bytes));
}

}  // namespace impactdic::video::sandbox
