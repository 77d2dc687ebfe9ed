// The rows of a run for those who read them one by one, wherever they are.
#pragma once

#include <impactdic/track.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

namespace impactdic {

// Rows that are not one array in memory.
class RowSource {
 public:
  virtual ~RowSource() = default;
  virtual std::size_t size() const = 0;
  // Of `i` < size(). Safe on several threads at once. Throws FileError where it is in a file.
  virtual TrackRow row(std::size_t i) const = 0;
};

// A view: what it was made from must outlive it, and its copies and parts.
class TrackRows {
 public:
  TrackRows(const std::vector<TrackRow>& rows) : array_(rows.data()), size_(rows.size()) {}
  TrackRows(const RowSource& source) : source_(&source), size_(source.size()) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  TrackRow operator[](std::size_t i) const {
    return array_ != nullptr ? array_[i] : source_->row(first_ + i);
  }
  // Rows begin … end - 1.
  TrackRows part(std::size_t begin, std::size_t end) const;
  // The first row of a frame, of rows in the order of their frames; nullopt where there is none.
  std::optional<std::size_t> find_frame(std::int64_t frame) const;

  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = TrackRow;
    using difference_type = std::ptrdiff_t;
    using pointer = const TrackRow*;
    using reference = TrackRow;
    Iterator(const TrackRows* rows, std::size_t at) : rows_(rows), at_(at) {}
    TrackRow operator*() const { return (*rows_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) { return {rows_, at_++}; }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const TrackRows* rows_;
    std::size_t at_;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size_}; }

 private:
  const TrackRow* array_ = nullptr;
  const RowSource* source_ = nullptr;
  std::size_t first_ = 0, size_ = 0;  // first_ of an array is 0
};

// What is done to the row of that number.
using RowChange = std::function<void(std::size_t, TrackRow&)>;

// The rows with something changed in each that is given out.
class ChangedRows final : public RowSource {
 public:
  // What `rows` were made from must outlive the object.
  ChangedRows(const TrackRows& rows, RowChange change) : rows_(rows), change_(std::move(change)) {}
  std::size_t size() const override { return rows_.size(); }
  TrackRow row(std::size_t i) const override {
    TrackRow row = rows_[i];
    change_(i, row);
    return row;
  }

 private:
  TrackRows rows_;
  RowChange change_;
};

// The rows with an empty one for every frame that is missing between them, and without motions
// across a gap: what an analysis that counts frames needs. `change` (may be empty) is done to every
// row that is given out.
class EvenRows final : public RowSource {
 public:
  // What `rows` were made from must outlive the object.
  explicit EvenRows(const TrackRows& rows, std::function<void(TrackRow&)> change = {});
  std::size_t size() const override { return size_; }
  TrackRow row(std::size_t i) const override;

 private:
  struct Gap {
    std::size_t even, row;  // of the row before it, here and among the given ones
    std::size_t periods;
  };
  TrackRow even_row(std::size_t i) const;

  TrackRows rows_;
  std::function<void(TrackRow&)> change_;
  std::vector<Gap> gaps_;
  std::size_t size_ = 0;
};

}  // namespace impactdic
