// Lines across the rim along pixel rows and columns, eight lines or eight samples at a time.
#include "host/circle/rim/rim_cast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/circle/settings/levels.h"

namespace impactdic::circle {
namespace {

static_assert(kSamples < kLanes && kDeep == kLanes);

[[gnu::always_inline]] inline void to_root(Lanes& v) {
  float x[kLanes];
  std::memcpy(x, &v, sizeof(v));
  for (float& each : x) each = std::sqrt(each);
  std::memcpy(&v, x, sizeof(v));
}

// The rim as a conic a X² + 2b XY + c Y² = 1 about its centre.
struct Conic {
  double a, b, c;
  explicit Conic(const Rim& rim) {
    const double e = std::hypot(rim.e1, rim.e2);
    const double l = 1 / ((rim.r + e) * (rim.r + e)), s = 1 / ((rim.r - e) * (rim.r - e));
    const double half = 0.5 * (l - s), per_e = e > 0 ? 1 / e : 0;
    a = 0.5 * (l + s) + half * rim.e1 * per_e;
    c = 0.5 * (l + s) - half * rim.e1 * per_e;
    b = half * rim.e2 * per_e;
  }
  Conic(double a_, double b_, double c_) : a(a_), b(b_), c(c_) {}
  Conic transposed() const { return {c, b, a}; }
};

// Lines along rows or columns: the sample at an excess of x lies x (per − x bend) beyond `at`, in
// pixels from `origin`, which is an element of the picture.
struct Courses {
  int n = 0;
  std::vector<float> at, per, bend;
  std::vector<int> origin;

  void resize(int lines) {  // whole blocks
    const auto blocks = static_cast<std::size_t>((lines + kLanes - 1) / kLanes * kLanes);
    n = lines;
    at.resize(blocks);
    per.resize(blocks);
    bend.resize(blocks);
    origin.resize(blocks);
  }
  void move(int from, int to) {
    at[to] = at[from];
    per[to] = per[from];
    bend[to] = bend[from];
    origin[to] = origin[from];
  }
};

[[gnu::always_inline]] inline void store(const Lanes& v, std::vector<float>& out, int at) {
  std::memcpy(out.data() + at, &v, sizeof(v));
}

// Where the lines of a quarter run, and where they cross the rim: into `lines` from `first` on.
IMPACTDIC_WIDE void lay(const RimQuarter& q, float step, Courses& courses, CastLines& lines,
                        int first) {
  const float det = q.a * q.c - q.b * q.b, per_c = 1 / q.c;
  const float order = q.u_step > 0 ? 1 : -1;
  const float inner = -kInside * step, outer = kOutside * step;
  const int n = courses.n;
  for (int i = 0; i < n; i += kLanes) {
    const Lanes x = q.u0 + q.u_step * (static_cast<float>(i) + kCount);
    Lanes gradient = q.c - det * x * x;
    to_root(gradient);
    const Lanes y = (q.side * gradient - q.b * x) * per_c;
    Lanes outside = x * x + y * y;
    to_root(outside);
    const Lanes per_outside = 1 / outside;
    const Lanes slope = outside * gradient;  // of the excess along v, outwards
    const Lanes per = q.side / slope;
    const Lanes bend = 0.5f * per_outside * (1 - slope * slope) * per * per * per;
    Lanes turn = 0.5f + 0.5f * order * q.side * x / y;
    turn = turn < 0 ? Lanes{} : turn > kLine.last_turn ? Lanes{} + kLine.last_turn : turn;
    store(y - q.v0, courses.at, i);
    store(per, courses.per, i);
    store(bend, courses.bend, i);
    store(x * per_outside, q.turn % 2 == 0 ? lines.sin : lines.cos, first + i);
    store(y * per_outside, q.turn % 2 == 0 ? lines.cos : lines.sin, first + i);
    store(turn + static_cast<float>(q.turn), lines.turn, first + i);
    for (int k = 0; k < kLanes; ++k) courses.origin[i + k] = q.origin + (i + k) * q.to_u;
  }
  int kept = 0;
  for (int i = 0; i < n; ++i) {
    const auto place = [&](float x) {
      return courses.at[i] + x * (courses.per[i] - x * courses.bend[i]);
    };
    const float one = place(inner), other = place(outer);
    if (std::min(one, other) < q.least || std::max(one, other) > q.most) continue;
    if (kept < i) {
      courses.move(i, kept);
      lines.cos[first + kept] = lines.cos[first + i];
      lines.sin[first + kept] = lines.sin[first + i];
      lines.turn[first + kept] = lines.turn[first + i];
    }
    ++kept;
  }
  courses.n = kept;
}

struct Scratch {
  Courses courses, deep;
  struct Sample {
    IntLanes index;      // of the first of four neighbours
    Lanes part;          // of the way from the second to the third
    IntLanes low, high;  // the neighbours, in bytes of `low` or in words of 16 bits
  };
  std::vector<Sample> lines;  // eight samples of each
};

template <typename T, typename Stride>
[[gnu::always_inline]] inline void gather(const T* pixels, Stride stride, int n, Scratch& s) {
  for (int i = 0; i < n; ++i) {
    int index[kLanes], low[kLanes], high[kLanes];
    std::memcpy(index, &s.lines[i].index, sizeof(index));
    for (int k = 0; k < kLanes; ++k) {
      const T* p = pixels + index[k];
      const std::uint32_t a = p[0], b = p[stride], c = p[2 * stride], d = p[3 * stride];
      if constexpr (sizeof(T) == 1) {
        low[k] = static_cast<int>(a | b << 8 | c << 16 | d << 24);
      } else {
        low[k] = static_cast<int>(a | b << 16);
        high[k] = static_cast<int>(c | d << 16);
      }
    }
    std::memcpy(&s.lines[i].low, low, sizeof(low));
    if constexpr (sizeof(T) == 2) std::memcpy(&s.lines[i].high, high, sizeof(high));
  }
}

// Samples lines at the `excess`es by Catmull and Rom's cubic; neighbours are `stride` elements
// apart.
template <typename T>
[[gnu::always_inline]] inline void take(const T* pixels, int stride, const Courses& courses,
                                        const Lanes& excess, float sign, Scratch& s, Eight* out) {
  const int n = courses.n;
  s.lines.resize(n);
  for (int i = 0; i < n; ++i) {
    const Lanes at = courses.at[i] + excess * (courses.per[i] - excess * courses.bend[i]);
    const IntLanes whole = __builtin_convertvector(at, IntLanes);
    s.lines[i].part = at - __builtin_convertvector(whole, Lanes);
    s.lines[i].index = (whole - 1) * stride + courses.origin[i];
  }
  if (stride == 1) {
    gather(pixels, std::integral_constant<int, 1>{}, n, s);
  } else {
    gather(pixels, stride, n, s);
  }
  constexpr int kMost = sizeof(T) == 1 ? 255 : 65535;
  for (int i = 0; i < n; ++i) {
    const IntLanes u = s.lines[i].low, v = sizeof(T) == 1 ? u >> 16 : s.lines[i].high;
    constexpr int kBits = 8 * sizeof(T);
    const Lanes a = __builtin_convertvector(u & kMost, Lanes);
    const Lanes b = __builtin_convertvector(u >> kBits & kMost, Lanes);
    const Lanes c = __builtin_convertvector(v & kMost, Lanes);
    const Lanes d = __builtin_convertvector(v >> kBits & kMost, Lanes);
    const Lanes t = s.lines[i].part;
    out[i].v =
        sign *
        (b + 0.5f * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a))));
  }
}
IMPACTDIC_WIDE void sample(const std::uint8_t* pixels, int stride, const Courses& courses,
                           const Lanes& excess, float sign, Scratch& s, Eight* out) {
  take(pixels, stride, courses, excess, sign, s, out);
}
IMPACTDIC_WIDE void sample(const std::uint16_t* pixels, int stride, const Courses& courses,
                           const Lanes& excess, float sign, Scratch& s, Eight* out) {
  take(pixels, stride, courses, excess, sign, s, out);
}

enum class Along { kColumns, kRows };

// A picture and a rim with lines along v, one every so many u; columns: v is y.
struct Axes {
  Conic conic;        // u for X, v for Y
  double u0, v0;      // the centre
  int width, height;  // of the picture, along u and v
  int to_u, to_v;     // elements from a pixel to the next one along u and v

  Axes(const PictureSize& picture, const Rim& rim, Along along) : conic(rim) {
    u0 = rim.cx, v0 = rim.cy;
    width = picture.width, height = picture.height;
    to_u = 1, to_v = picture.pitch;
    if (along == Along::kColumns) return;
    conic = conic.transposed();
    std::swap(u0, v0);
    std::swap(width, height);
    std::swap(to_u, to_v);
  }
};

// Lines of quarter `turn`; `side` is the sign of v, `order` that of u from line to line. `cast`
// gains those outside the picture, too.
RimQuarter quarter_of(const PictureSize& picture, const Rim& rim, const Casting& how, int turn,
                      Along along, int side, int order, int& cast) {
  const Axes at(picture, rim, along);
  const Conic& conic = at.conic;
  RimQuarter q = {};
  // The normal lies along v rather than along u between the points where it does so by 45°.
  const auto end = [&](int sign) {
    const double det = conic.a * conic.c - conic.b * conic.b;
    return (conic.c * sign - conic.b * side) /
           std::sqrt(det * (conic.a + conic.c - 2 * conic.b * side * sign));
  };
  const int low = static_cast<int>(std::ceil(at.u0 + end(-1)));
  const int high = static_cast<int>(std::floor(at.u0 + end(1)));
  if (high < low) return q;
  const int stride =
      std::max(1, static_cast<int>(std::ceil(4 * std::sqrt(2.0) * rim.r / how.most_lines)));
  const int all = (high - low) / stride + 1, step = order * stride;
  cast += all;
  int start = order > 0 ? low : high, n = all;
  const auto in = [&](int u) { return u >= 0 && u < at.width; };
  for (; n > 0 && !in(start); --n) start += step;
  while (n > 0 && !in(start + (n - 1) * step)) --n;
  if (n == 0) return q;
  // v is told from a pixel so far out that it is positive, and small as numbers go.
  const double reach = rim.r + std::hypot(rim.e1, rim.e2) + 2 * kOutside * how.step_px + 4;
  const int from = static_cast<int>(std::floor(at.v0 - reach));
  q.a = static_cast<float>(conic.a);
  q.b = static_cast<float>(conic.b);
  q.c = static_cast<float>(conic.c);
  q.u0 = static_cast<float>(start - at.u0);
  q.v0 = static_cast<float>(from - at.v0);
  q.u_step = static_cast<float>(step);
  q.side = static_cast<float>(side);
  q.least = kLine.least_v_px - static_cast<float>(from);
  q.most = static_cast<float>(at.height - from) - kLine.most_v_px;
  q.turn = turn;
  q.origin = start * at.to_u + from * at.to_v;
  q.to_u = step * at.to_u;
  q.to_v = at.to_v;
  q.lines = n;
  return q;
}

template <typename T>
class Caster {
 public:
  Caster(ImageView<const T> picture, const Rim& rim, const Casting& how, CastLines& lines)
      : picture_(picture), rim_(rim), sign_(sign_of(how.polarity)), how_(how), lines_(lines) {}

  void cast(const RimQuarter& q) {
    if (q.lines == 0) return;
    static thread_local Scratch scratch;  // memory only
    const int first = static_cast<int>(lines_.level.size());
    scratch.courses.resize(q.lines);
    lines_.resize(first + q.lines);
    lay(q, static_cast<float>(how_.step_px), scratch.courses, lines_, first);
    lines_.resize(first + scratch.courses.n);
    const Lanes inwards = {-3, -2, -1, 0, 1, 2, 3, 3};
    static_assert(kInside == 3 && kOutside == 3);
    sample(picture_.data, q.to_v, scratch.courses, inwards * static_cast<float>(how_.step_px),
           sign_, scratch, lines_.level.data() + first);
    if (how_.deep_every > 0) deepen(q, first, scratch);
  }

 private:
  void deepen(const RimQuarter& q, int first, Scratch& scratch) {
    const float step = deep_step_px(rim_, how_);
    const Courses& all = scratch.courses;
    Courses& deep = scratch.deep;
    const auto before = lines_.deep_line.size();
    const float deepest = -(kInside + kDeep) * step;
    deep.resize(all.n / how_.deep_every + 1);
    int n = 0;
    for (int i = 0; i < all.n; i += how_.deep_every) {
      const float v = all.at[i] + deepest * (all.per[i] - deepest * all.bend[i]);
      if (v < q.least || v > q.most) continue;
      deep.at[n] = all.at[i];
      deep.per[n] = all.per[i];
      deep.bend[n] = all.bend[i];
      deep.origin[n] = all.origin[i];
      ++n;
      const int line = first + i;
      const float c = lines_.cos[line], s = lines_.sin[line];
      const float outside = static_cast<float>(rim_.radius_at(c * c - s * s, 2.0 * c * s));
      const float middle =
          (outside - (kInside + 0.5f * (1 + kDeep)) * step) / static_cast<float>(rim_.r);
      lines_.deep_line.push_back(line);
      lines_.deep_x.push_back(middle * c);
      lines_.deep_y.push_back(middle * s);
    }
    deep.n = n;
    lines_.deep_level.resize(before + n);
    sample(picture_.data, q.to_v, deep, -step * (static_cast<float>(kInside + 1) + kCount), sign_,
           scratch, lines_.deep_level.data() + before);
  }

  ImageView<const T> picture_;
  Rim rim_;
  float sign_;
  Casting how_;
  CastLines& lines_;
};

template <typename T>
void cast(ImageView<const T> picture, const Rim& rim, const Casting& how, CastLines& lines) {
  Caster<T> caster(picture, rim, how, lines);
  const PictureSize size = {picture.width, picture.height, static_cast<int>(picture.pitch)};
  for (const RimQuarter& q : quarters_of(size, rim, how, lines.cast)) caster.cast(q);
}

}  // namespace

float deep_step_px(const Rim& rim, const Casting& how) {
  return std::min(static_cast<float>(how.step_px), static_cast<float>(rim.r) / kLine.deep_per_r);
}

std::array<RimQuarter, 4> quarters_of(const PictureSize& picture, const Rim& rim,
                                      const Casting& how, int& cast) {
  cast = 0;
  const auto quarter = [&](int turn, Along along, int side, int order) {
    return quarter_of(picture, rim, how, turn, along, side, order, cast);
  };
  return {quarter(0, Along::kRows, 1, 1), quarter(1, Along::kColumns, 1, -1),
          quarter(2, Along::kRows, -1, -1), quarter(3, Along::kColumns, -1, 1)};
}

void CastLines::resize(int lines) {
  const auto blocks = static_cast<std::size_t>(lines) + kLanes - 1;
  cos.resize(blocks);
  sin.resize(blocks);
  turn.resize(blocks);
  level.resize(static_cast<std::size_t>(lines));
}

void cast_lines(const Frame& frame, const Rim& rim, const Casting& how, CastLines& lines) {
  lines.resize(0);
  lines.deep_line.clear();
  lines.deep_x.clear();
  lines.deep_y.clear();
  lines.deep_level.clear();
  if (frame.type == PixelType::kU8) {
    cast(frame.u8.view(), rim, how, lines);
  } else {
    cast(frame.u16.view(), rim, how, lines);
  }
}

}  // namespace impactdic::circle
