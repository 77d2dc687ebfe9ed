#include "host/report/journaled_file.h"

#include <fcntl.h>
#include <impactdic/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

#include "host/base/sha256.h"

namespace impactdic::report {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kPage = 4096;
constexpr std::size_t kDigestLength = 64;  // hexadecimal SHA-256

[[noreturn]] void fail(const char* what, const fs::path& path) {
  const int code = errno;
  throw FileError(std::string(what) + ": " + std::generic_category().message(code), path.string(),
                  code == ENOSPC || code == EDQUOT ? "the disk is full" : "");
}

void append(std::string& text, std::uint64_t number) {
  for (int i = 0; i < 8; ++i) text.push_back(static_cast<char>(number >> (8 * i) & 0xff));
}

std::uint64_t number_at(const std::string& text, std::size_t at) {
  std::uint64_t number = 0;
  for (std::size_t i = 8; i-- > 0;) number = number << 8 | static_cast<unsigned char>(text[at + i]);
  return number;
}

}  // namespace

fs::path JournaledFile::journal_of(const fs::path& file) { return file.string() + ".journal"; }

JournaledFile::JournaledFile(fs::path path, bool is_new) : path_(std::move(path)), is_new_(is_new) {
  const int flags = is_new ? O_CREAT | O_TRUNC : 0;
  file_ = ::open((is_new ? unnamed() : path_).c_str(), flags | O_RDWR | O_CLOEXEC, 0666);
  if (file_ < 0) fail("cannot open the file", path_);
}

JournaledFile JournaledFile::create(fs::path path) {
  std::error_code error;  // of an older file: its end would spoil this one
  fs::remove(journal_of(path), error);
  if (error) throw FileError("cannot remove the file: " + error.message(), path.string());
  return {std::move(path), true};
}

JournaledFile JournaledFile::open(fs::path path) {
  JournaledFile file(std::move(path), false);
  file.apply_journal();
  struct stat found = {};
  if (::fstat(file.file_, &found) != 0) fail("cannot read the file", file.path_);
  file.committed_ = file.size_ = static_cast<std::uint64_t>(found.st_size);
  return file;
}

JournaledFile::JournaledFile(JournaledFile&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      is_new_(other.is_new_),
      committed_(other.committed_),
      size_(other.size_),
      pages_(std::move(other.pages_)) {}

JournaledFile::~JournaledFile() {
  if (file_ < 0) return;
  try {
    if (applying_) apply_journal();  // what failed once may go now; else who opens it next does it
  } catch (const std::exception&) {
  }
  ::close(file_);
  if (is_new_) ::unlink(unnamed().c_str());
}

std::pair<std::uint64_t, std::uint64_t> JournaledFile::identity() const {
  struct stat found = {};
  if (::fstat(file_, &found) != 0) fail("cannot read the file", path_);
  return {found.st_dev, found.st_ino};
}

void JournaledFile::read_file(std::uint64_t at, std::span<std::uint8_t> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got =
        ::pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("cannot read the file", path_);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(done), bytes.end(), std::uint8_t{0});
}

void JournaledFile::write_file(std::uint64_t at, std::span<const std::uint8_t> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put =
        ::pwrite(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) fail("cannot write the file", path_);
    done += static_cast<std::size_t>(put);
  }
}

std::vector<std::uint8_t>& JournaledFile::page(std::uint64_t index) {
  const auto [found, is_new] = pages_.try_emplace(index);
  if (is_new) {
    found->second.resize(kPage);
    read_file(index * kPage, found->second);
  }
  return found->second;
}

void JournaledFile::read(std::uint64_t at, std::span<std::uint8_t> bytes) const {
  read_file(at, bytes);
  const std::uint64_t end = std::min(at + bytes.size(), committed_);
  for (auto it = pages_.lower_bound(at / kPage); it != pages_.end(); ++it) {
    const std::uint64_t begin = it->first * kPage;
    if (begin >= end) break;
    const std::uint64_t from = std::max(at, begin), to = std::min(end, begin + kPage);
    std::memcpy(bytes.data() + (from - at), it->second.data() + (from - begin), to - from);
  }
}

void JournaledFile::write(std::uint64_t at, std::span<const std::uint8_t> bytes) {
  const std::uint64_t end = at + bytes.size(), kept = std::min(end, committed_);
  std::uint64_t from = at;
  while (from < kept) {
    const std::uint64_t index = from / kPage, to = std::min(kept, (index + 1) * kPage);
    std::memcpy(page(index).data() + from % kPage, bytes.data() + (from - at), to - from);
    from = to;
  }
  if (from < end) write_file(from, bytes.subspan(from - at));
  size_ = std::max(size_, end);
}

// The file's size, then offset, length and bytes of each change, behind the digest of all that.
void JournaledFile::write_journal() const {
  std::string body;
  append(body, size_);
  for (const auto& [index, bytes] : pages_) {
    const std::uint64_t begin = index * kPage;
    const std::uint64_t length = std::min(kPage, committed_ - begin);
    append(body, begin);
    append(body, length);
    body.append(reinterpret_cast<const char*>(bytes.data()), length);
  }
  const fs::path journal = journal_of(path_), part = journal.string() + ".part";
  {
    std::ofstream file(part, std::ios::binary | std::ios::trunc);
    file << sha256_of_text(body) << body << std::flush;
    if (!file) fail("cannot write the file", part);
  }
  std::error_code error;
  fs::rename(part, journal, error);
  if (error) throw FileError("cannot write the file: " + error.message(), journal.string());
}

void JournaledFile::apply_journal() {
  const fs::path journal = journal_of(path_);
  std::ifstream stream(journal, std::ios::binary);
  if (!stream) return;
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string body = text.substr(std::min(text.size(), kDigestLength));
  if (body.size() < 8 || sha256_of_text(body) != text.substr(0, kDigestLength)) {
    throw FormatError(journal.string(), -1, "the journal is damaged",
                      "--force without --resume starts anew");
  }
  const std::uint64_t size = number_at(body, 0);
  for (std::size_t at = 8; at + 16 <= body.size();) {
    const std::uint64_t begin = number_at(body, at), length = number_at(body, at + 8);
    at += 16;
    if (length > body.size() - at || length > kPage || begin > size + kPage) {
      throw FormatError(journal.string(), -1, "the journal is damaged");
    }
    write_file(begin, {reinterpret_cast<const std::uint8_t*>(body.data()) + at, length});
    at += length;
  }
  if (::ftruncate(file_, static_cast<off_t>(size)) != 0) fail("cannot write the file", path_);
  fs::remove(journal);
}

void JournaledFile::commit() {
  const bool in_place = !pages_.empty() || size_ < committed_;
  const auto set_size = [&] {
    if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) fail("cannot write the file", path_);
  };
  if (size_ >= committed_) set_size();  // harms nothing; what may fail comes before the journal
  if (in_place) write_journal();
  applying_ = in_place;
  for (const auto& [index, bytes] : pages_) {
    const std::uint64_t begin = index * kPage;
    write_file(begin, std::span(bytes).first(std::min(kPage, committed_ - begin)));
  }
  if (size_ < committed_) set_size();
  if (in_place) fs::remove(journal_of(path_));
  applying_ = false;
  pages_.clear();
  committed_ = size_;
  if (!is_new_) return;
  if (::rename(unnamed().c_str(), path_.c_str()) != 0) fail("cannot write the file", path_);
  is_new_ = false;
}

}  // namespace impactdic::report
