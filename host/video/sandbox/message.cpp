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

std::string Message::bytes() {
  const std::int64_t size = number();
  if (size < 0 || static_cast<std::uint64_t>(size) > bytes_.size() - at_) {
    throw Error("the codecs' process sent too little");
  }
  std::string found = bytes_.substr(at_, static_cast<std::size_t>(size));
  at_ += found.size();
  return found;
}

std::string Message::text() {
  std::string text = bytes();
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

bool Request::send(int socket) const {
  Message message;
  message.add(static_cast<std::int64_t>(content)).add(static_cast<std::int64_t>(channel));
  message.add(static_cast<std::int64_t>(paths.size()));
  std::size_t bytes = 0;
  for (const std::string& path : paths) {
    if (bytes + path.size() > kLongestMessage / 2) {
      if (!message.send(socket)) return false;
      message = Message();
      bytes = 0;
    }
    message.add(path);
    bytes += path.size() + sizeof(std::int64_t);
  }
  return message.send(socket);
}

std::optional<Request> Request::receive(int socket) {
  bool late = false;
  auto message = Message::receive(socket, -1, late);
  if (!message) return std::nullopt;
  Request request;
  request.content = static_cast<Content>(message->number());
  request.channel = static_cast<Channel>(message->number());
  for (std::int64_t left = message->number(); left > 0; --left) {
    if (message->at_end()) message = Message::receive(socket, -1, late);
    if (!message) return std::nullopt;
    request.paths.push_back(message->bytes());
  }
  return request;
}

}  // namespace impactdic::video::sandbox
