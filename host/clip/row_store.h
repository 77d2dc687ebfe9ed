// Where the rows of a run are kept until it ends: however long it is, memory holds no more of them.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "host/clip/track_rows.h"

namespace impactdic {

// Rows come back bit for bit. The first `in_memory` ones stay there; of a longer run all go into a
// file of `folder` that has no name, and so is gone with the process, however that ends.
class RowStore final : public RowSource {
 public:
  static constexpr std::size_t kInMemory = 65536;  // 28 MB
  explicit RowStore(std::filesystem::path folder, std::size_t in_memory = kInMemory);
  ~RowStore() override;
  RowStore(const RowStore&) = delete;
  RowStore& operator=(const RowStore&) = delete;

  // Throws FileError where the disk refuses; the row is kept then, too.
  void push_back(const TrackRow& row);
  std::size_t size() const override { return in_file_ + last_.size(); }
  TrackRow row(std::size_t i) const override;

 private:
  // Rows that were read together. Several, since an analysis looks at two places in turn, and some
  // run side by side.
  struct Block {
    std::size_t index = 0;
    std::vector<TrackRow> rows;
  };
  void open();
  void write_last();
  const Block& block(std::size_t index) const;

  std::filesystem::path folder_;
  std::size_t in_memory_;
  int file_ = -1;
  std::size_t in_file_ = 0;     // whole blocks
  std::vector<TrackRow> last_;  // behind those in the file
  mutable std::mutex mutex_;    // of what follows
  mutable std::array<Block, 8> blocks_;
  mutable std::size_t next_ = 0;  // that is given up
};

}  // namespace impactdic
