// Bytes that a file lends instead of copying them, and pictures that are made of them.
#include "host/video/byte_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <impactdic/error.h>
#include <impactdic/image.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/scratch.h"

namespace impactdic {
namespace {

// Whether this system can read pages of a file in advance: Linux from 5.14 on.
bool system_lends(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY);
  void* page = ::mmap(nullptr, 1, PROT_READ, MAP_SHARED, descriptor, 0);
  ::close(descriptor);
  const bool lends = page != MAP_FAILED && ::madvise(page, 1, MADV_POPULATE_READ) == 0;
  if (page != MAP_FAILED) ::munmap(page, 1);
  return lends;
}

class LentBytes : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!system_lends(write(1))) GTEST_SKIP() << "this system cannot lend";
  }
  // A file of `count` bytes, of which no neighbours are equal.
  std::string write(std::size_t count) {
    bytes_.resize(count);
    std::iota(bytes_.begin(), bytes_.end(), std::uint8_t{1});
    const std::string path = scratch_ / "bytes";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes_.data()),
               static_cast<std::streamsize>(bytes_.size()));
    return path;
  }
  const testing::ScratchFolder scratch_;
  std::vector<std::uint8_t> bytes_;
};

// Kilobytes of files and of shared memory in this program's resident memory.
long resident_file_kB() {
  std::ifstream status("/proc/self/status");
  long sum = 0;
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("RssFile:") || line.starts_with("RssShmem:")) {
      sum += std::stol(line.substr(line.find(':') + 1));
    }
  }
  return sum;
}

TEST_F(LentBytes, AreThoseOfTheFile) {
  const video::ByteFile file(write(20000), true);
  for (const std::size_t offset : {0u, 4096u, 4999u, 19990u}) {
    const auto lent = file.lend(static_cast<std::int64_t>(offset), 10);
    ASSERT_TRUE(lent);
    EXPECT_TRUE(std::equal(lent.get(), lent.get() + 10, bytes_.begin() + offset)) << offset;
  }
  EXPECT_EQ(file.lend(19991, 10), nullptr);
  EXPECT_EQ(file.lend(-1, 10), nullptr);
}

TEST_F(LentBytes, OutliveTheFile) {
  std::shared_ptr<const std::uint8_t[]> lent;
  {
    video::ByteFile file(write(5000), true);
    const video::ByteFile moved(std::move(file));
    lent = moved.lend(4100, 100);
  }
  ASSERT_TRUE(lent);
  EXPECT_TRUE(std::equal(lent.get(), lent.get() + 100, bytes_.begin() + 4100));
}

TEST_F(LentBytes, AreNotThoseOfAFileThatBecameShorter) {
  const std::string path = write(100000);
  const video::ByteFile file(path, true);
  std::filesystem::resize_file(path, 50000);
  EXPECT_EQ(file.lend(60000, 1000), nullptr);
  std::vector<std::uint8_t> out(1000);
  EXPECT_THROW(file.read_at(60000, out.data(), out.size()), FormatError);
}

TEST_F(LentBytes, AnEmptyFileHasNone) {
  EXPECT_EQ(video::ByteFile(write(0), true).lend(0, 1), nullptr);
}

TEST_F(LentBytes, DoNotStayResident) {
  constexpr std::size_t kPiece = 250000, kPieces = 400;  // 100 MB
  const video::ByteFile file(write(kPiece * kPieces), true);
  const long before = resident_file_kB();
  std::vector<std::shared_ptr<const std::uint8_t[]>> held(3);
  for (std::size_t i = 0; i < kPieces; ++i) {
    held[i % held.size()] = file.lend(static_cast<std::int64_t>(i * kPiece), kPiece);
    ASSERT_TRUE(held[i % held.size()]);
    EXPECT_EQ(held[i % held.size()][0], bytes_[i * kPiece]);
  }
  EXPECT_LT(resident_file_kB() - before, 30000);
}

TEST_F(LentBytes, AreCopiedWhenAPictureChangesThem) {
  const video::ByteFile file(write(6000), true);
  auto lent = file.lend(0, 6000);
  ASSERT_TRUE(lent);
  Image<std::uint8_t> image;
  image.borrow(lent, 100, 60);
  const Image<std::uint8_t>& unchanged = image;
  EXPECT_EQ(unchanged.data(), lent.get());
  EXPECT_EQ(unchanged(7, 2), bytes_[207]);
  Image<std::uint8_t> copy = image;
  copy(7, 2) = 0;
  EXPECT_EQ(copy.row(2)[7], 0);
  EXPECT_EQ(copy(8, 2), bytes_[208]);
  EXPECT_EQ(unchanged(7, 2), bytes_[207]);
  EXPECT_EQ(lent[207], bytes_[207]);
  image.resize(3, 2);
  EXPECT_EQ(image.size(), 6u);
  EXPECT_NE(unchanged.data(), lent.get());
}

}  // namespace
}  // namespace impactdic
