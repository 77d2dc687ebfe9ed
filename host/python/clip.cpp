#include "host/python/clip.h"

#include <impactdic/error.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "host/python/array_source.h"
#include "host/python/arrays.h"
#include "host/python/options.h"

namespace nb = nanobind;

namespace impactdic::python {
namespace {

using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;

// Keeps arrays of Python alive from threads that know nothing of Python.
template <typename T>
std::shared_ptr<const void> kept(T value) {
  return {new T(std::move(value)), [](const void* pointer) {
            const nb::gil_scoped_acquire gil;
            delete static_cast<const T*>(pointer);
          }};
}

int bytes_of(const AnyArray& array, int bits) {
  const bool wide = array.dtype() == nb::dtype<std::uint16_t>();
  if (!wide && array.dtype() != nb::dtype<std::uint8_t>()) {
    throw InvalidArgument("pictures are arrays of uint8 or uint16", "array");
  }
  if (wide != (bits > 8)) {
    throw InvalidArgument(
        "pixels of " + std::to_string(bits) + " bits do not go with " + (wide ? "uint16" : "uint8"),
        "bits", wide ? "9 to 16 bits" : "1 to 8 bits");
  }
  return wide ? 2 : 1;
}

// Size and strides of pictures out of the last two axes of an array.
ArrayFrames layout_of(const AnyArray& array, int bits, double fps) {
  ArrayFrames frames;
  const std::size_t rows = array.ndim() - 2;
  frames.item_bytes = bytes_of(array, bits);
  frames.height = static_cast<int>(std::min<std::size_t>(array.shape(rows), 1u << 30));
  frames.width = static_cast<int>(std::min<std::size_t>(array.shape(rows + 1), 1u << 30));
  frames.row_bytes = array.stride(rows) * frames.item_bytes;
  frames.pixel_bytes = array.stride(rows + 1) * frames.item_bytes;
  // An axis of one pixel has whatever stride.
  if (frames.width == 1) frames.pixel_bytes = frames.item_bytes;
  if (frames.height == 1) frames.row_bytes = std::ptrdiff_t{frames.width} * frames.item_bytes;
  frames.bits = bits;
  frames.fps = fps;
  return frames;
}

std::shared_ptr<PythonClip> from_array(AnyArray array, int bits, double fps, bool release_pages) {
  if (array.ndim() != 3) {
    throw InvalidArgument("a clip has the shape (frames, height, width)", "array");
  }
  ArrayFrames frames = layout_of(array, bits, fps);
  const auto* first = static_cast<const std::uint8_t*>(array.data());
  const std::ptrdiff_t step = array.stride(0) * frames.item_bytes;
  for (std::size_t k = 0; k < array.shape(0); ++k) {
    frames.frames.push_back(first + static_cast<std::ptrdiff_t>(k) * step);
  }
  frames.release_pages = release_pages;
  frames.owner = kept(std::move(array));
  return std::make_shared<PythonClip>(PythonClip{array_source(std::move(frames)), {}, {}});
}

std::shared_ptr<PythonClip> from_pictures(std::vector<AnyArray> pictures, int bits, double fps) {
  if (pictures.empty()) throw InvalidArgument("the clip has no frames", "array");
  for (const AnyArray& picture : pictures) {
    if (picture.ndim() != 2)
      throw InvalidArgument("a picture has the shape (height, width)", "array");
  }
  ArrayFrames frames = layout_of(pictures.front(), bits, fps);
  for (const AnyArray& picture : pictures) {
    const ArrayFrames same = layout_of(picture, bits, fps);
    if (same.width != frames.width || same.height != frames.height) {
      throw InvalidArgument("the pictures differ in size", "array");
    }
    if (same.row_bytes != frames.row_bytes || same.pixel_bytes != frames.pixel_bytes) {
      throw InvalidArgument("the pictures differ in how they lie in memory", "array");
    }
    frames.frames.push_back(picture.data());
  }
  frames.owner = kept(std::move(pictures));
  return std::make_shared<PythonClip>(PythonClip{array_source(std::move(frames)), {}, {}});
}

void copy_into(Frame& frame, const AnyArray& picture, int bits) {
  const ArrayFrames layout = layout_of(picture, bits, 0);
  frame.reset(layout.width, layout.height, bits);
  for (int y = 0; y < layout.height; ++y) {
    const auto* from = static_cast<const std::uint8_t*>(picture.data()) + y * layout.row_bytes;
    for (int x = 0; x < layout.width; ++x, from += layout.pixel_bytes) {
      void* const to = bits > 8 ? static_cast<void*>(frame.u16.row(y) + x) : frame.u8.row(y) + x;
      std::memcpy(to, from, static_cast<std::size_t>(layout.item_bytes));
    }
  }
}

// `read(index)` returns a picture of the size that is stated here.
std::shared_ptr<PythonClip> from_function(nb::callable read, std::int64_t count, int height,
                                          int width, int bits, double fps) {
  ClipInfo info;
  info.path = "array";
  info.width = width;
  info.height = height;
  info.bits = bits;
  info.frame_count = count;
  if (fps > 0) info.fps = fps;
  auto held = std::static_pointer_cast<const nb::callable>(kept(std::move(read)));
  auto source = clip_from_callback(std::move(info), [held, bits](std::int64_t index, Frame& frame) {
    const nb::gil_scoped_acquire gil;
    const nb::object made = (*held)(index);
    AnyArray picture;
    if (!nb::try_cast(made, picture) || picture.ndim() != 2) {
      throw InvalidArgument(
          "frame " + std::to_string(index) + " is no array of the shape (height, width)", "array");
    }
    copy_into(frame, picture, bits);
  });
  return std::make_shared<PythonClip>(PythonClip{std::move(source), {}, {}});
}

std::shared_ptr<PythonClip> from_files(std::vector<std::string> paths, const nb::dict& options) {
  ClipRequest request;
  OptionReader reader(options);
  run::visit_reading(reader, request);
  reader.finish("open");
  auto clip = std::make_shared<PythonClip>();
  clip->paths = std::move(paths);
  clip->open = request.open;
  const nb::gil_scoped_release released;
  clip->source = open_clip(clip->paths, clip->open);
  return clip;
}

nb::object optional(const std::optional<double>& value) {
  return value ? nb::cast(*value) : nb::none();
}

nb::dict describe(const PythonClip& clip) {
  const ClipInfo& info = clip.source->info();
  nb::dict facts;
  facts["path"] = info.path;
  facts["format"] = info.format;
  facts["camera"] = info.camera;
  facts["storage"] = info.storage;
  facts["width"] = info.width;
  facts["height"] = info.height;
  facts["bits"] = info.bits;
  facts["frames"] = info.frame_count;
  facts["first_frame_number"] = info.first_frame_number;
  facts["fps"] = optional(info.fps);
  facts["exposure_s"] = optional(info.exposure_s);
  facts["recorded_at"] = info.recorded_at ? nb::cast(*info.recorded_at) : nb::none();
  facts["has_timestamps"] = info.has_timestamps;
  facts["warnings"] = nb::cast(info.warnings);
  nb::dict extra;
  for (const auto& [name, value] : info.extra) extra[name.c_str()] = value;
  facts["extra"] = extra;
  return facts;
}

// (count, height, width), a copy.
nb::object read(const PythonClip& clip, std::int64_t first, std::int64_t count, std::int64_t step) {
  const ClipInfo& info = clip.source->info();
  const auto height = static_cast<std::size_t>(info.height);
  const auto width = static_cast<std::size_t>(info.width);
  const std::size_t wanted = static_cast<std::size_t>(std::max<std::int64_t>(count, 0));
  const std::size_t item = info.bits > 8 ? 2 : 1;
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  {
    const nb::gil_scoped_release released;
    item == 1 ? bytes.resize(wanted * height * width) : words.resize(wanted * height * width);
    auto* to = item == 1 ? bytes.data() : reinterpret_cast<std::uint8_t*>(words.data());
    Frame frame;
    for (std::size_t k = 0; k < wanted; ++k) {
      clip.source->read(first + static_cast<std::int64_t>(k) * step, frame);
      std::memcpy(to + k * height * width * item, frame.bytes(), frame.byte_count());
    }
  }
  const std::vector<std::size_t> shape{wanted, height, width};
  return item == 1 ? to_numpy(std::move(bytes), shape) : to_numpy(std::move(words), shape);
}

}  // namespace

void put_into(ClipRequest& request, const PythonClip& clip) {
  request.paths = clip.paths;
  request.open = clip.open;
  if (clip.paths.empty()) request.source = clip.source;
}

void bind_clip(nb::module_& module) {
  nb::class_<PythonClip>(module, "Clip")
      .def("info", &describe)
      .def("read", &read, nb::arg("first"), nb::arg("count"), nb::arg("step"))
      .def("time_s", [](const PythonClip& clip,
                        std::int64_t index) { return optional(clip.source->frame_time_s(index)); })
      .def_prop_ro("paths", [](const PythonClip& clip) { return clip.paths; });
  module.def("clip_from_files", &from_files, nb::arg("paths"), nb::arg("options"));
  module.def("clip_from_array", &from_array, nb::arg("array"), nb::arg("bits"), nb::arg("fps"),
             nb::arg("release_pages"));
  module.def("clip_from_pictures", &from_pictures, nb::arg("pictures"), nb::arg("bits"),
             nb::arg("fps"));
  module.def("clip_from_function", &from_function, nb::arg("read"), nb::arg("count"),
             nb::arg("height"), nb::arg("width"), nb::arg("bits"), nb::arg("fps"));
}

}  // namespace impactdic::python
