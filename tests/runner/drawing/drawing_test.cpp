// The SVG writer, axes and labels: well formed, round, nothing that is not a number.
#include <stdexcept>
#include <string>
#include <vector>

#include <rapidcheck.h>

#include "analysis/numerics/special_values.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/drawing/svg.h"
#include "tests/catch.h"
#include "tests/runner/markup_check.h"

using namespace jnd;

TEST_CASE("markup is escaped, and what could reorder or break it replaced") {
  CHECK(escape_markup("a<b>&\"'") == "a&lt;b&gt;&amp;&quot;&#39;");
  CHECK(escape_markup("Größe 刺激") == "Größe 刺激");
  CHECK(escape_markup("x\xe2\x80\xaey") == "x\xef\xbf\xbdy");  // U+202E, right-to-left override
  CHECK(escape_markup("x\xe2\x81\xa6y") == "x\xef\xbf\xbdy");  // U+2066, isolate
  CHECK(escape_markup(std::string("a\0b", 3)) ==
        "a\xef\xbf\xbd"
        "b");  // a control character
  CHECK(escape_markup("a\x1b[2Jb") == "a\xef\xbf\xbd[2Jb");
  CHECK(escape_markup("\xff\xc0\x80") == "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");  // not UTF-8, overlong
  CHECK(escape_markup("\xed\xa0\x80").find('\xed') == std::string::npos);          // a surrogate
  CHECK(escape_markup("\xf0\x9f\x98") == "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");  // cut off
  REQUIRE(rc::check("never a bare mark, whatever the bytes", [](const std::string& bytes) {
    RC_ASSERT(markup_problem("<p a=\"" + escape_markup(bytes) + "\">" + escape_markup(bytes) + "</p>").empty());
  }));
}

TEST_CASE("coordinates are short decimals, and never anything but numbers") {
  CHECK(svg_number(12.5) == "12.5");
  CHECK(svg_number(-3) == "-3");
  CHECK(svg_number(-0.001) == "0");
  CHECK(svg_number(100) == "100");
  CHECK(svg_number(1.005e6) == "1005000");
  CHECK_THROWS_AS(svg_number(kNaN), std::logic_error);
  CHECK_THROWS_AS(svg_number(kInf), std::logic_error);
  Svg svg("a", 10, 10, "t<", "d&");
  CHECK_THROWS_AS(svg.circle(kNaN, 1, 1, kFrame), std::logic_error);
  svg.text(1, 2, "</text><script>", kLabel);
  CHECK(markup_problem(svg.file()).empty());
  CHECK(svg.file().find("<script") == std::string::npos);
}

TEST_CASE("axes have round ends and labels of one length") {
  const Range range = round_range(3, 97, 5);
  CHECK(range.low == 0);
  CHECK(range.high == 100);
  CHECK(round_range(5, 5, 5).low < 5);
  CHECK_THROWS_AS(round_range(0, kInf, 5), std::logic_error);
  CHECK(tick_labels({0, 0.5, 1}) == std::vector<std::string>{"0.0", "0.5", "1.0"});
  CHECK(tick_labels({-100, 0}) == std::vector<std::string>{"−100", "0"});
  const Scale scale{0, 10, 100, 0};
  CHECK(scale.at(5) == 50);
  CHECK(scale.clipped(kInf) == 0);
  CHECK_THROWS_AS(scale.clipped(kNaN), std::logic_error);
  REQUIRE(rc::check("a rounded range holds what it was made for", [] {
    const double low = *rc::gen::inRange(-100'000, 100'000) / 100.0, width = *rc::gen::inRange(0, 100'000) / 1000.0;
    const Range wide = round_range(low, low + width, 6);
    RC_ASSERT(wide.low <= low + 1e-9 && wide.high >= low + width - 1e-9 && wide.low < wide.high);
  }));
}

TEST_CASE("long labels are cut between characters") {
  CHECK(fitted("short", 12, 100) == "short");
  const std::string cut = fitted("刺激の強さを比べる実験", 12, 60);
  CHECK(cut.ends_with("…"));
  CHECK(escape_markup(cut) == cut);
  CHECK(text_width(cut, 12) <= 61);
}

TEST_CASE("logarithmic axes have round ticks, and equal ratios lie equally far apart") {
  const Range range = ratio_range(0.5, 2);
  CHECK(range.low < 0.5);
  CHECK(range.high > 2);
  const Scale scale{range.low, range.high, 100, 500, true};
  CHECK(scale.at(range.low) == Approx(100));
  CHECK(scale.at(range.high) == Approx(500));
  CHECK(scale.at(1) - scale.at(0.5) == Approx(scale.at(2) - scale.at(1)));
  for (const auto& [low, high] : {std::pair{0.5, 2.0}, {0.97, 1.04}, {1e-3, 1e4}, {99.0, 101.0}, {150.0, 3000.0}}) {
    const std::vector<double> ticks = ticks_of({low, high, 0, 1, true}, 6);
    CHECK(ticks.size() >= 1);
    CHECK(ticks.size() <= 12);
    for (const double tick : ticks) {
      CHECK(tick >= low);
      CHECK(tick <= high);
    }
  }
  CHECK_THROWS_AS(ratio_range(0, 1), std::logic_error);
}
