// What passes between the program and the process that decodes for it: numbers and texts in order.
// The process is not trusted: whoever reads what it says checks every length.
#pragma once

#include <impactdic/clip.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace impactdic::video::sandbox {

// Where the process finds what it was started with.
inline constexpr int kSocket = 3, kMemory = 4;
// Frames that lie in the shared memory at a time: one that is being copied, others decoded ahead.
inline constexpr int kSlots = 4;
inline constexpr std::size_t kLongestMessage = 60000;  // a packet that every system takes

enum class Answer : std::int64_t { kDone, kInvalidArgument, kFormatError, kFileError, kError };

class Message {
 public:
  Message() = default;
  explicit Message(std::string bytes) : bytes_(std::move(bytes)) {}

  Message& add(std::int64_t number);
  Message& add(double number);
  Message& add(const std::string& text);
  // In the order in which they were added. Throw Error where the message is shorter.
  std::int64_t number();
  double real();
  std::string text();   // characters that a terminal obeys come as spaces
  std::string bytes();  // as they were added
  bool at_end() const { return at_ == bytes_.size(); }

  // False where the other side is gone.
  bool send(int socket) const;
  // Nothing where the other side is gone; waits at most `longest_ms`, -1: for ever. Sets `late`
  // where that has passed.
  static std::optional<Message> receive(int socket, int longest_ms, bool& late);

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

// One file but for pictures, which form a sequence.
enum class Content : std::int64_t { kContainer, kPictures, kTiff };

// What the process is to decode, the first that it is told: as many messages as the names need.
struct Request {
  Content content = Content::kContainer;
  std::vector<std::string> paths;
  Channel channel = Channel::kLuminance;

  // False where the other side is gone.
  bool send(int socket) const;
  static std::optional<Request> receive(int socket);
};

}  // namespace impactdic::video::sandbox
