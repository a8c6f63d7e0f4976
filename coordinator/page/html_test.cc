#include "coordinator/page/html.h"

#include <gtest/gtest.h>

namespace cairn::page {
namespace {

TEST(Html, NothingThatAStrangerWroteIsAnElementOrEndsAValue) {
  EXPECT_EQ(Text("<script>alert('1')</script>&\"x\""),
            "&lt;script&gt;alert(&#39;1&#39;)&lt;/script&gt;&amp;&quot;x&quot;");
  EXPECT_EQ(Text("Löß \x1b[31m \xff"), "Löß \\u001b[31m \\xff");
  EXPECT_EQ(UrlPart("a/../b?c#d e\"<ü"), "a%2F..%2Fb%3Fc%23d%20e%22%3C%C3%BC");
}

TEST(Html, FiguresAreShort) {
  EXPECT_EQ(Number(0), "0");
  EXPECT_EQ(Number(-1234.5678), "-1235");
  EXPECT_EQ(Number(0.012345), "0.01235");
  EXPECT_EQ(Number(12.3456), "12.35");
  EXPECT_EQ(Number(1.5e9), "1.5e+09");
  EXPECT_EQ(Duration(59.6), "1:00");
  EXPECT_EQ(Duration(3661), "1:01:01");
  EXPECT_EQ(Duration(-3), "0:00");
  EXPECT_EQ(Count(1, "job"), "1 job");
  EXPECT_EQ(Count(0, "job"), "0 jobs");
}

TEST(Html, AStateIsToldByAShapeAndAWord) {
  const std::string failed = StateBadge("failed"), done = StateBadge("done");
  EXPECT_NE(failed.find("</svg>failed"), std::string::npos);
  EXPECT_NE(failed.substr(failed.find("<path")), done.substr(done.find("<path")));
  EXPECT_EQ(StateBadge("<b>").find("<b>"), std::string::npos);
  EXPECT_EQ(ProgressBar(-1, "x"), "");
  EXPECT_NE(ProgressBar(7, "x").find("value=\"1.000\""), std::string::npos);
}

}  // namespace
}  // namespace cairn::page
