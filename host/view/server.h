// The HTTP side of the page: 127.0.0.1 alone, a random token in the address, and nothing answered
// that does not ask as the page does.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/view/page_request.h"

namespace impactdic::view {

// Answers a request that has the token. Called from several threads at once. InvalidArgument
// becomes 400, NotThere 404, Overtaken 409, every other Error 500, each with {"error": LINE}.
using Answer = std::function<PageAnswer(const PageRequest&)>;

class Server {
 public:
  // Takes the port, 0: a free one. Throws FileError where it is taken.
  Server(int port, Answer answer);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // "http://127.0.0.1:PORT/TOKEN/".
  const std::string& address() const;
  // Serves until `stopped`, which is asked every 50 ms.
  void serve(const std::function<bool()>& stopped);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Bytes of a request's body above which it is refused (413).
inline constexpr std::size_t kLargestBody = std::size_t{1} << 20;

}  // namespace impactdic::view
