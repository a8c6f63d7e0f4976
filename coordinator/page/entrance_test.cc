#include "coordinator/page/entrance.h"

#include <gtest/gtest.h>

#include <set>

namespace cairn::page {
namespace {

using coordinator::HttpRequest;

class EntranceTest : public ::testing::Test {
 protected:
  Entrance Make(EntranceOptions options = {.address = "127.0.0.1:8080", .proxy = "", .password = ""}) {
    return {std::move(options), [this](const std::string& link) { links_.push_back(link); }};
  }
  static HttpRequest Request(std::map<std::string, std::string> headers) {
    return {.method = "POST", .path = "/", .headers = std::move(headers)};
  }
  static HttpRequest With(const std::string& set_cookie) {
    return Request({{"cookie", "other=1; " + set_cookie.substr(0, set_cookie.find(';')) + "; more=2"}});
  }
  std::string Token() const { return links_.back().substr(links_.back().find('=') + 1); }

  std::vector<std::string> links_;
};

TEST_F(EntranceTest, ALinkWorksOnceAndThenThereIsAnother) {
  Entrance entrance = Make();
  ASSERT_EQ(links_.size(), 1u);
  EXPECT_TRUE(links_[0].starts_with("http://127.0.0.1:8080/?token=")) << links_[0];
  const std::string first = Token();
  EXPECT_EQ(first.size(), 48u);
  EXPECT_FALSE(entrance.TakeToken("", 0));
  EXPECT_FALSE(entrance.TakeToken(first.substr(0, 47), 0));
  EXPECT_FALSE(entrance.TakeToken(first.substr(0, 47) + "x", 0));
  const auto cookie = entrance.TakeToken(first, 0);
  ASSERT_TRUE(cookie);
  EXPECT_FALSE(entrance.TakeToken(first, 0));
  ASSERT_EQ(links_.size(), 2u);
  EXPECT_NE(Token(), first);
  EXPECT_TRUE(entrance.Knows(With(*cookie), 1));
}

TEST_F(EntranceTest, ACookieIsOutOfReachOfScriptsAndOtherSitesAndOfPlainHttpBehindTls) {
  Entrance here = Make();
  const std::string cookie = *here.TakeToken(Token(), 0);
  EXPECT_NE(cookie.find("; HttpOnly"), std::string::npos) << cookie;
  EXPECT_NE(cookie.find("; SameSite=Strict"), std::string::npos) << cookie;
  EXPECT_TRUE(cookie.starts_with("cairn_page_8080=")) << cookie;
  Entrance behind = Make({.address = "127.0.0.1:8080", .proxy = "https://maps.example.org", .password = ""});
  EXPECT_TRUE(links_.back().starts_with("https://maps.example.org/?token="));
  const std::string secure = *behind.TakeToken(Token(), 0);
  EXPECT_TRUE(secure.starts_with("__Host-cairn_page=")) << secure;
  EXPECT_NE(secure.find("; Secure"), std::string::npos) << secure;
}

// A browser sends all cookies of a host to each of its ports, those of longer paths first.
TEST_F(EntranceTest, CookiesOfOtherServicesOfTheHostArePassedOver) {
  Entrance entrance = Make();
  const std::string ours = *entrance.TakeToken(Token(), 0), cookie = ours.substr(0, ours.find(';'));
  const std::string masses = [] {
    std::string cookies;
    for (int i = 0; i < 200; ++i) cookies += "cairn_page_" + std::to_string(9000 + i) + "=a; ";
    return cookies;
  }();
  for (const std::string& cookies :
       {cookie, "cairn_page_8080=; " + cookie, "cairn_page_8080=another; cairn_page_8080=third; " + cookie,
        cookie + "; cairn_page_8080=later", "xcairn_page_8080=x; " + cookie, masses + cookie}) {
    EXPECT_TRUE(entrance.Knows(Request({{"cookie", cookies}}), 1)) << cookies;
    EXPECT_NE(entrance.FormToken(Request({{"cookie", cookies}})), "") << cookies;
  }
  for (const std::string& cookies :
       {"x" + cookie, "cairn_page_80801" + cookie.substr(cookie.find('=')), cookie + "x", masses}) {
    EXPECT_FALSE(entrance.Knows(Request({{"cookie", cookies}}), 1)) << cookies;
    EXPECT_FALSE(entrance.IsFormToken(Request({{"cookie", cookies}}), "")) << "nobody's is empty";
  }
}

TEST_F(EntranceTest, WhoHasNoCookieOrAnotherOrAnOldOneIsNotKnown) {
  Entrance entrance = Make();
  const std::string cookie = *entrance.TakeToken(Token(), 0);
  EXPECT_FALSE(entrance.Knows(Request({}), 0));
  EXPECT_FALSE(entrance.Knows(Request({{"cookie", "cairn_page_8080="}}), 0));
  EXPECT_FALSE(entrance.Knows(Request({{"cookie", "cairn_page_8080=" + std::string(48, '0')}}), 0));
  EXPECT_FALSE(entrance.Knows(Request({{"cookie", "x" + cookie.substr(0, cookie.find(';'))}}), 0));
  EXPECT_TRUE(entrance.Knows(With(cookie), 80'000));
  EXPECT_TRUE(entrance.Knows(With(cookie), 160'000)) << "each look counts from anew";
  EXPECT_FALSE(entrance.Knows(With(cookie), 260'000));
  EXPECT_FALSE(entrance.Knows(With(cookie), 160'001)) << "it is over for good";
}

TEST_F(EntranceTest, WhoSignsOutIsNotKnownAndOthersAre) {
  Entrance entrance = Make();
  const std::string one = *entrance.TakeToken(Token(), 0), two = *entrance.TakeToken(Token(), 0);
  entrance.Forget(With(one));
  EXPECT_FALSE(entrance.Knows(With(one), 0));
  EXPECT_TRUE(entrance.Knows(With(two), 0));
}

TEST_F(EntranceTest, WrongPasswordsAreFewAMinute) {
  Entrance none = Make();
  EXPECT_EQ(none.TakePassword("", 0).status().code(), Code::kRefused) << "no password lets nobody in";
  Entrance entrance = Make({.address = "0.0.0.0:8080", .proxy = "", .password = "correct horse"});
  EXPECT_TRUE(entrance.TakePassword("correct horse", 0).ok());
  int tried = 0;
  while (tried < 1000 &&
         entrance.TakePassword("wrong " + std::to_string(tried), 0).status().code() == Code::kRefused)
    ++tried;
  EXPECT_EQ(tried, 10);
  EXPECT_EQ(entrance.TakePassword("correct horse", 0).status().code(), Code::kBusy);
  EXPECT_TRUE(entrance.TakePassword("correct horse", 6).ok()) << "one of them is forgiven by then";
  for (const char* wrong : {"", "correct hors", "correct horse ", "Correct horse"})
    EXPECT_FALSE(entrance.TakePassword(wrong, 1000).ok()) << wrong;
}

// A name of another site that leads to this machine (DNS rebinding) is not this page's.
TEST_F(EntranceTest, AnotherNameIsNotServed) {
  const auto wrong = [](const Entrance& entrance, const std::string& host) {
    return !entrance.WhatIsWrongWithHost(Request({{"host", host}})).empty();
  };
  const Entrance here = Make();
  for (const char* host : {"127.0.0.1:8080", "localhost:8080", "[::1]:8080"})
    EXPECT_FALSE(wrong(here, host)) << host;
  for (const char* host :
       {"", "evil.example:8080", "127.0.0.1:8081", "127.0.0.1", "localhost.evil.example:8080"})
    EXPECT_TRUE(wrong(here, host)) << host;
  const Entrance behind =
      Make({.address = "127.0.0.1:8080", .proxy = "https://maps.example.org", .password = ""});
  EXPECT_FALSE(wrong(behind, "maps.example.org"));
  EXPECT_TRUE(wrong(behind, "127.0.0.1:8080")) << "past the proxy";
  const Entrance open = Make({.address = "0.0.0.0:8080", .proxy = "", .password = "correct horse"});
  EXPECT_FALSE(wrong(open, "hub.example.org:8080"));
}

TEST_F(EntranceTest, WhatAnotherSitesPageSendsIsNotOurOwn) {
  const Entrance here = Make();
  const auto ours = [](const Entrance& entrance, std::map<std::string, std::string> headers) {
    return entrance.IsOurOwn(Request(std::move(headers)));
  };
  EXPECT_TRUE(ours(
      here,
      {{"host", "127.0.0.1:8080"}, {"origin", "http://127.0.0.1:8080"}, {"sec-fetch-site", "same-origin"}}));
  EXPECT_TRUE(ours(here, {{"host", "127.0.0.1:8080"}}));
  for (const char* origin :
       {"null", "https://evil.example", "http://127.0.0.1:9999", "https://127.0.0.1:8080"})
    EXPECT_FALSE(ours(here, {{"host", "127.0.0.1:8080"}, {"origin", origin}})) << origin;
  for (const char* site : {"cross-site", "same-site", "none"})
    EXPECT_FALSE(ours(here, {{"host", "127.0.0.1:8080"}, {"sec-fetch-site", site}})) << site;
  const Entrance behind =
      Make({.address = "127.0.0.1:8080", .proxy = "https://maps.example.org", .password = ""});
  EXPECT_TRUE(ours(behind, {{"host", "maps.example.org"}, {"origin", "https://maps.example.org"}}));
  EXPECT_FALSE(ours(behind, {{"host", "maps.example.org"}, {"origin", "http://maps.example.org"}}));
}

TEST(RandomText, IsLongAndNeverTheSame) {
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(seen.insert(RandomText(24)).second);
  EXPECT_EQ(RandomText(5).size(), 10u);
}

TEST(FormValues, AreDecoded) {
  auto values = FormValues("password=a%2Bb+c%zz&x=&=y&flag");
  EXPECT_EQ(values["password"], "a+b c%zz");
  EXPECT_EQ(values["x"], "");
  EXPECT_EQ(values.count("flag"), 1u);
  EXPECT_TRUE(FormValues("").empty());
}

TEST_F(EntranceTest, BrowsersLeaveOutASchemesOwnPortAndWriteNamesSmall) {
  const Entrance plain = Make({.address = "127.0.0.1:80", .proxy = "", .password = ""});
  for (const char* host : {"127.0.0.1", "127.0.0.1:80", "localhost"})
    EXPECT_EQ(plain.WhatIsWrongWithHost(Request({{"host", host}})), "") << host;
  EXPECT_NE(plain.WhatIsWrongWithHost(Request({{"host", "evil.example.org"}})), "");
  for (const char* proxy : {"https://Maps.Example.org", "https://maps.example.org:443"}) {
    const Entrance behind = Make({.address = "127.0.0.1:8080", .proxy = proxy, .password = ""});
    EXPECT_EQ(behind.WhatIsWrongWithHost(Request({{"host", "maps.example.org"}})), "") << proxy;
    EXPECT_TRUE(links_.back().starts_with("https://maps.example.org/")) << links_.back();
  }
}

}  // namespace
}  // namespace cairn::page
