#include "host/clip/row_store.h"

#include <fcntl.h>
#include <impactdic/error.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>

namespace impactdic {
namespace {

constexpr std::size_t kBlock = 512;  // rows: 200 KB
static_assert(std::is_trivially_copyable_v<TrackRow>);

[[noreturn]] void fail_store(const char* what, const std::filesystem::path& folder) {
  const int code = errno;
  throw FileError(std::string(what) + ": " + std::generic_category().message(code), folder.string(),
                  code == ENOSPC || code == EDQUOT ? "the disk is full" : "");
}

off_t place_of(std::size_t row) { return static_cast<off_t>(row * sizeof(TrackRow)); }

}  // namespace

RowStore::RowStore(std::filesystem::path folder, std::size_t in_memory)
    : folder_(std::move(folder)), in_memory_(std::max(in_memory, kBlock)) {}

RowStore::~RowStore() {
  if (file_ >= 0) ::close(file_);
}

void RowStore::open() {
  if (file_ >= 0) return;
  file_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file_ >= 0) return;
  // A file system that knows no file without a name.
  std::string name = (folder_ / ".rows-XXXXXX").string();
  file_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) fail_store("cannot open a file for the rows", folder_);
  ::unlink(name.c_str());
}

void RowStore::push_back(const TrackRow& row) {
  last_.push_back(row);
  if (size() > in_memory_ && last_.size() >= kBlock) write_last();
}

// Whole blocks.
void RowStore::write_last() {
  open();
  const std::size_t count = last_.size() / kBlock * kBlock;
  const auto* bytes = reinterpret_cast<const char*>(last_.data());
  const std::size_t all = count * sizeof(TrackRow);
  for (std::size_t done = 0; done < all;) {
    const ssize_t put =
        ::pwrite(file_, bytes + done, all - done, place_of(in_file_) + static_cast<off_t>(done));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) fail_store("cannot write the rows", folder_);
    done += static_cast<std::size_t>(put);
  }
  last_.erase(last_.begin(), last_.begin() + static_cast<std::ptrdiff_t>(count));
  if (last_.capacity() > 2 * kBlock) last_.shrink_to_fit();
  in_file_ += count;
}

TrackRow RowStore::row(std::size_t i) const {
  if (i >= in_file_) return last_[i - in_file_];
  const std::lock_guard<std::mutex> lock(mutex_);
  return block(i / kBlock).rows[i % kBlock];
}

const RowStore::Block& RowStore::block(std::size_t index) const {
  for (const Block& known : blocks_) {
    if (known.index == index && !known.rows.empty()) return known;
  }
  Block& read = blocks_[next_];
  next_ = (next_ + 1) % blocks_.size();
  read.rows.resize(kBlock);
  auto* bytes = reinterpret_cast<char*>(read.rows.data());
  const std::size_t all = kBlock * sizeof(TrackRow);
  for (std::size_t done = 0; done < all;) {
    const ssize_t got = ::pread(file_, bytes + done, all - done,
                                place_of(index * kBlock) + static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      read.rows.clear();
      fail_store("cannot read the rows", folder_);
    }
    done += static_cast<std::size_t>(got);
  }
  read.index = index;
  return read;
}

}  // namespace impactdic
