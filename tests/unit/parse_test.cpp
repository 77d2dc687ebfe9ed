#include "host/base/parse.h"

#include <gtest/gtest.h>
#include <impactdic/error.h>

#include <cmath>

namespace impactdic {
namespace {

TEST(Parse, NumbersMustBeTheWholeText) {
  EXPECT_EQ(parse_int(" 42 ", "--n"), 42);
  EXPECT_DOUBLE_EQ(parse_double("-2.5e3", "--x"), -2500);
  EXPECT_DOUBLE_EQ(parse_double("+1", "--x"), 1);
  for (const char* bad : {"", "4x", "1 2", "nan", "inf", "--1", "0x10"}) {
    EXPECT_THROW(parse_double(bad, "--x"), InvalidArgument) << bad;
  }
  EXPECT_THROW(parse_int("1.5", "--n"), InvalidArgument);
}

TEST(Parse, ListsAreCounted) {
  EXPECT_EQ(parse_doubles("1,2.5,-3", ',', 3, "--roi"), (std::vector<double>{1, 2.5, -3}));
  EXPECT_THROW(parse_doubles("1,2", ',', 3, "--roi"), InvalidArgument);
  EXPECT_THROW(parse_doubles("1,,2", ',', 3, "--roi"), InvalidArgument);
}

TEST(Parse, ShortestReadsBackExactly) {
  for (double value : {0.1, 1.0 / 3, 1e-300, -2.647, 30000.0}) {
    EXPECT_EQ(parse_double(shortest(value), "value"), value);
  }
  EXPECT_EQ(shortest(std::nan("")), "");
}

TEST(Parse, ADeviationIsToldToItsSecondDigit) {
  EXPECT_EQ(plus_minus(2.2834, 0.00471), "2.2834 +- 0.0047");
  EXPECT_EQ(plus_minus(0.30000451, 2.07e-7), "0.30000451 +- 0.00000021");
  EXPECT_EQ(plus_minus(-17.26, 0.0996), "-17.26 +- 0.10");
  EXPECT_EQ(plus_minus(1234.5, 217), "1234 +- 217");
  EXPECT_EQ(plus_minus(0.3, 0), "0.3 +- 0");
}

TEST(Error, IsOneLineWithPlaceAndHint) {
  const FormatError error("a.cine", 44, "width is\n0", "is it a cine file?");
  EXPECT_EQ(error.line(), "width is 0 (a.cine, byte 44): is it a cine file?");
}

}  // namespace
}  // namespace impactdic
