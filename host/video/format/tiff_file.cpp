#include "host/video/format/tiff_file.h"

#include <impactdic/error.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <unordered_set>

#include "host/video/channel.h"
#include "host/video/unpack.h"

namespace impactdic::video {
namespace {

// Keeps libtiff's message for our own error instead of printing it.
int keep_error(TIFF*, void* text, const char* module, const char* format, va_list arguments) {
  char line[400];
  std::vsnprintf(line, sizeof line, format, arguments);
  *static_cast<std::string*>(text) = std::string(module ? module : "libtiff") + ": " + line;
  return 1;
}
int ignore_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

TIFF* open_handle(const std::string& path, std::string* error) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, kMaxFrameBytes);
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, error);
  TIFFOpenOptionsSetWarningHandlerExtR(options, ignore_warning, nullptr);
  // m: no memory map, so that a file cut while it is read is an error and no signal.
  TIFF* handle = TIFFOpenExt(path.c_str(), "rm", options);
  TIFFOpenOptionsFree(options);
  return handle;
}

std::string compression_name(std::uint16_t scheme) {
  const TIFFCodec* codec = TIFFFindCODEC(scheme);
  return scheme == COMPRESSION_NONE ? "uncompressed"
         : codec                    ? codec->name
                                    : "compression " + std::to_string(scheme);
}

std::string text_field(TIFF* handle, std::uint32_t tag) {
  const char* text = nullptr;
  return TIFFGetField(handle, tag, &text) == 1 && text ? text : "";
}

// Why a page is not read; "" where it is.
std::string why_not(TIFF* handle, const TiffPage& page, std::uint16_t compression) {
  std::uint16_t format = SAMPLEFORMAT_UINT;
  TIFFGetFieldDefaulted(handle, TIFFTAG_SAMPLEFORMAT, &format);
  if (page.depth != 8 && page.depth != 16) return std::to_string(page.depth) + " bits a sample";
  if (format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_VOID) {
    return "samples that are no unsigned integers";
  }
  if (page.samples < 1 || page.samples > 8) {
    return std::to_string(page.samples) + " samples a pixel";
  }
  if (!TIFFIsCODECConfigured(compression)) return compression_name(compression);
  switch (page.photometric) {
    case PHOTOMETRIC_MINISWHITE:
    case PHOTOMETRIC_MINISBLACK:
      return page.samples > 2 ? "grey of more than two samples" : "";
    case PHOTOMETRIC_PALETTE:
      return page.depth != 8 || page.samples != 1 ? "a palette of other than 8 bits" : "";
    case PHOTOMETRIC_YCBCR:
      return compression != COMPRESSION_JPEG || page.samples != 3 ? "YCbCr without JPEG" : "";
    case PHOTOMETRIC_RGB:
      return page.samples < 3 ? "RGB of fewer than 3 samples" : "";
    default:
      return "photometric interpretation " + std::to_string(page.photometric);
  }
}

// A palette's grey levels; 8-bit, one entry a code.
std::vector<std::uint8_t> palette_table(TIFF* handle, const std::string& path, Channel channel) {
  std::uint16_t *red = nullptr, *green = nullptr, *blue = nullptr;
  if (TIFFGetField(handle, TIFFTAG_COLORMAP, &red, &green, &blue) != 1) {
    throw FormatError(path, -1, "a palette picture without a palette");
  }
  std::vector<std::uint8_t> table(256);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = grey_of<std::uint8_t>(channel, red[i] >> 8, green[i] >> 8, blue[i] >> 8);
  }
  return table;
}

// One stored row of interleaved samples to grey.
template <typename T>
void grey_row(const T* in, std::size_t samples, Channel channel, std::size_t count, T* out) {
  if (samples < 3) {  // a second sample is transparency
    for (std::size_t x = 0; x < count; ++x) out[x] = in[x * samples];
    return;
  }
  for (std::size_t x = 0; x < count; ++x) {
    const T* p = in + x * samples;
    out[x] = grey_of<T>(channel, p[0], p[1], p[2]);
  }
}

template <typename T>
void orient(const TiffPage& page, Image<T>& image) {
  for (int y = 0; page.flip_columns && y < image.height(); ++y) {
    std::reverse(image.row(y), image.row(y) + image.width());
  }
  if (page.flip_rows) flip_rows(image);
}

// Decodes strips or tiles block by block, each straight into its place.
template <typename T>
class PageDecoder {
 public:
  // `buffer` holds one block of all planes.
  PageDecoder(TIFF* handle, const TiffPage& page, std::vector<std::uint8_t>& buffer)
      : handle_(handle), page_(page), buffer_(buffer) {
    width_ = page.tiled ? field(TIFFTAG_TILEWIDTH) : page.width;
    height_ =
        page.tiled ? field(TIFFTAG_TILELENGTH) : std::min(field(TIFFTAG_ROWSPERSTRIP), page.height);
    planes_ = page.planar && page.samples >= 3 ? 3 : 1;
    row_bytes_ = std::uint64_t{width_} * (page.planar ? 1 : page.samples) * sizeof(T);
    block_bytes_ = row_bytes_ * height_;
  }

  // False where libtiff reports an error or the blocks' sizes contradict the page.
  bool decode(Image<T>& image) {
    const tmsize_t expected = page_.tiled ? TIFFTileSize(handle_) : TIFFStripSize(handle_);
    if (expected <= 0 || static_cast<std::uint64_t>(expected) != block_bytes_ ||
        block_bytes_ * planes_ > static_cast<std::uint64_t>(kMaxFrameBytes)) {
      return false;
    }
    buffer_.resize(static_cast<std::size_t>(block_bytes_) * planes_);
    for (std::uint32_t y = 0; y < page_.height; y += height_) {
      for (std::uint32_t x = 0; x < page_.width; x += width_) {
        for (int plane = 0; plane < planes_; ++plane) {
          if (!read_block(x, y, plane)) return false;
        }
        place_block(x, y, image);
      }
    }
    return true;
  }

 private:
  std::uint32_t field(std::uint32_t tag) const {
    std::uint32_t value = 0;
    TIFFGetFieldDefaulted(handle_, tag, &value);
    return value;
  }

  bool read_block(std::uint32_t x, std::uint32_t y, int plane) {
    std::uint8_t* out = buffer_.data() + plane * block_bytes_;
    const auto sample = static_cast<std::uint16_t>(plane);
    if (page_.tiled) {
      const auto size = static_cast<tmsize_t>(block_bytes_);
      return TIFFReadEncodedTile(handle_, TIFFComputeTile(handle_, x, y, 0, sample), out, size) ==
             size;
    }
    const auto size = static_cast<tmsize_t>(row_bytes_ * std::min(height_, page_.height - y));
    return TIFFReadEncodedStrip(handle_, TIFFComputeStrip(handle_, y, sample), out, size) == size;
  }

  // Blocks at the right and lower edges may reach beyond the picture.
  void place_block(std::uint32_t x, std::uint32_t y, Image<T>& image) const {
    const std::uint32_t columns = std::min(width_, page_.width - x);
    const std::uint32_t rows = std::min(height_, page_.height - y);
    const std::size_t plane = block_bytes_ / sizeof(T);
    for (std::uint32_t r = 0; r < rows; ++r) {
      T* out = image.row(static_cast<int>(y + r)) + x;
      const auto* in = reinterpret_cast<const T*>(buffer_.data() + r * row_bytes_);
      if (planes_ == 3) {
        for (std::uint32_t c = 0; c < columns; ++c) {
          out[c] = grey_of<T>(page_.channel, in[c], in[c + plane], in[c + 2 * plane]);
        }
      } else {
        grey_row(in, page_.planar ? 1 : page_.samples, page_.channel, columns, out);
      }
      if (page_.photometric == PHOTOMETRIC_MINISWHITE) {
        std::transform(out, out + columns, out, [](T value) { return static_cast<T>(~value); });
      }
    }
  }

  TIFF* handle_;
  const TiffPage& page_;
  std::vector<std::uint8_t>& buffer_;
  std::uint32_t width_ = 0, height_ = 0;  // of a block
  int planes_ = 1;
  std::uint64_t row_bytes_ = 0, block_bytes_ = 0;
};

}  // namespace

std::vector<std::uint64_t> tiff_page_offsets(const ByteFile& file) {
  const std::string& path = file.path();
  const auto head =
      file.bytes_at(0, std::min<std::int64_t>(16, std::max<std::int64_t>(8, file.size())));
  const bool big_endian = head[0] == 'M';
  // Up to eight bytes as one number in the file's byte order.
  const auto load = [big_endian](const std::uint8_t* p, int count) {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i) value = value << 8 | p[big_endian ? i : count - 1 - i];
    return value;
  };
  const bool big_tiff = load(&head[2], 2) == 43;
  if (big_tiff && head.size() < 16) throw FormatError(path, 0, "the file ends too early");
  const int word = big_tiff ? 8 : 4, count_bytes = big_tiff ? 8 : 2, entry = big_tiff ? 20 : 12;
  std::vector<std::uint64_t> offsets;
  std::unordered_set<std::uint64_t> seen;
  std::uint64_t at = load(&head[big_tiff ? 8 : 4], word);
  while (at != 0) {
    const auto offset = static_cast<std::int64_t>(at);
    if (!seen.insert(at).second) throw FormatError(path, offset, "the chain of pages loops");
    const std::uint64_t tags = load(file.bytes_at(offset, count_bytes).data(), count_bytes);
    if (tags > 65535) throw FormatError(path, offset, "a page with absurdly many tags");
    offsets.push_back(at);
    const auto next = offset + count_bytes + static_cast<std::int64_t>(tags) * entry;
    at = load(file.bytes_at(next, word).data(), word);
  }
  if (offsets.empty()) throw FormatError(path, 4, "the TIFF holds no page");
  return offsets;
}

TiffFile::TiffFile(const std::string& path, std::int64_t file_size)
    : path_(path), file_size_(file_size) {
  TIFF* handle = open_handle(path, &error_);
  if (handle == nullptr) throw FormatError(path, -1, "not a readable TIFF", error_);
  handle_ = std::shared_ptr<TIFF>(handle, TIFFClose);
}

TiffFile::~TiffFile() = default;

TiffPage TiffFile::go_to(std::uint64_t offset) {
  TIFF* handle = handle_.get();
  error_.clear();
  if (TIFFSetSubDirectory(handle, offset) != 1) {
    throw FormatError(path_, static_cast<std::int64_t>(offset), "a damaged TIFF page", error_);
  }
  TiffPage page;
  std::uint16_t planar = PLANARCONFIG_CONTIG, orientation = ORIENTATION_TOPLEFT;
  std::uint16_t compression = COMPRESSION_NONE;
  TIFFGetField(handle, TIFFTAG_IMAGEWIDTH, &page.width);
  TIFFGetField(handle, TIFFTAG_IMAGELENGTH, &page.height);
  TIFFGetFieldDefaulted(handle, TIFFTAG_BITSPERSAMPLE, &page.depth);
  TIFFGetFieldDefaulted(handle, TIFFTAG_SAMPLESPERPIXEL, &page.samples);
  TIFFGetFieldDefaulted(handle, TIFFTAG_PLANARCONFIG, &planar);
  TIFFGetFieldDefaulted(handle, TIFFTAG_ORIENTATION, &orientation);
  TIFFGetFieldDefaulted(handle, TIFFTAG_COMPRESSION, &compression);
  TIFFGetField(handle, TIFFTAG_PHOTOMETRIC, &page.photometric);
  page.planar = planar == PLANARCONFIG_SEPARATE && page.samples > 1;
  page.tiled = TIFFIsTiled(handle) != 0;
  page.flip_columns = orientation == ORIENTATION_TOPRIGHT || orientation == ORIENTATION_BOTRIGHT;
  page.flip_rows = orientation == ORIENTATION_BOTRIGHT || orientation == ORIENTATION_BOTLEFT;
  page.compression = compression_name(compression);
  page.description = text_field(handle, TIFFTAG_IMAGEDESCRIPTION);
  page.camera = text_field(handle, TIFFTAG_MODEL);
  const std::string refusal =
      orientation > 4 ? "a picture lying on its side" : why_not(handle, page, compression);
  if (!refusal.empty()) {
    throw FormatError(path_, static_cast<std::int64_t>(offset), "unsupported TIFF: " + refusal,
                      "8 and 16-bit grey, palette, RGB and YCbCr pictures are read");
  }
  if (page.photometric == PHOTOMETRIC_YCBCR) {
    TIFFSetField(handle, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
  }
  check_frame_size(path_, page.width, page.height, page.depth / 8 * page.samples);
  // No coder packs better than this; a header that claims more is damaged.
  const std::int64_t best = compression == COMPRESSION_NONE ? 1 : 4096;
  const std::int64_t bytes =
      std::int64_t{page.width} * page.height * page.samples * (page.depth / 8);
  if (bytes / best > file_size_) throw FormatError(path_, -1, "pictures larger than the file");
  return page;
}

void TiffFile::decode(const TiffPage& page, Frame& frame) {
  frame.reset(static_cast<int>(page.width), static_cast<int>(page.height), page.depth);
  bool decoded = false;
  error_.clear();
  if (frame.type == PixelType::kU8) {
    decoded = PageDecoder<std::uint8_t>(handle_.get(), page, rows_).decode(frame.u8);
    if (decoded && page.photometric == PHOTOMETRIC_PALETTE) {
      const auto table = palette_table(handle_.get(), path_, page.channel);
      std::transform(frame.u8.data(), frame.u8.data() + frame.u8.size(), frame.u8.data(),
                     [&table](std::uint8_t code) { return table[code]; });
    }
    orient(page, frame.u8);
  } else {
    decoded = PageDecoder<std::uint16_t>(handle_.get(), page, rows_).decode(frame.u16);
    orient(page, frame.u16);
  }
  if (!decoded) throw FormatError(path_, -1, "the TIFF picture cannot be decoded", error_);
}

}  // namespace impactdic::video
