#include "coordinator/page/site.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "coordinator/page/assets.h"
#include "coordinator/page/testing/site_fixture.h"

namespace cairn::page {
namespace {

using coordinator::HttpAnswer;

class SiteTest : public SiteFixture {};

TEST_F(SiteTest, AStrangerSeesNothingAndDoesNothing) {
  cookie_ = "";
  for (const char* path : {"/", "/workers", "/jobs/1-hall", "/jobs/1-hall/log.txt", "/jobs/1-hall/rounds.csv",
                           "/jobs/1-hall/report", "/events", "/x"}) {
    const HttpAnswer answer = Get(path);
    EXPECT_EQ(answer.code, 401u) << path;
    EXPECT_EQ(answer.body.find("hall"), std::string::npos) << path;
    EXPECT_NE(answer.body.find("cairn page"), std::string::npos) << "what to do is said";
  }
  EXPECT_EQ(Ask("POST", "/jobs/1-hall/cancel", {}, {{"x-cairn", "page"}}).code, 401u);
  EXPECT_EQ(Ask("GET", "/", {{"token", "wrong"}}).code, 401u);
  EXPECT_TRUE(source_->looks.empty()) << "the coordinator is not even asked";
  EXPECT_TRUE(source_->commands.empty());
  EXPECT_EQ(Get("/page.css").code, 200u);
}

TEST_F(SiteTest, ALinkLetsInOnceAndLeadsToThePagesOfItself) {
  const std::string token = link_.substr(link_.find('=') + 1);
  cookie_ = "";
  const HttpAnswer welcome = Ask("GET", "/", {{"token", token}});
  EXPECT_EQ(welcome.code, 200u);
  EXPECT_NE(HeaderOf(welcome, "Set-Cookie"), "");
  EXPECT_NE(welcome.body.find("url=/"), std::string::npos);
  EXPECT_EQ(welcome.body.find(token), std::string::npos);
  EXPECT_EQ(Ask("GET", "/", {{"token", token}}).code, 401u);
}

TEST_F(SiteTest, ThePasswordLetsInWhereThereIsOne) {
  cookie_ = "";
  EXPECT_EQ(Get("/").body.find("<form"), std::string::npos);
  Make({}, "correct horse");
  cookie_ = "";
  EXPECT_NE(Get("/").body.find("<form class=\"login\""), std::string::npos);
  EXPECT_EQ(Ask("POST", "/login", {}, {}, "password=wrong").code, 401u);
  EXPECT_NE(HeaderOf(Ask("POST", "/login", {}, {}, "password=correct+horse"), "Set-Cookie"), "");
  for (int i = 0; i < 20; ++i) Ask("POST", "/login", {}, {}, "password=wrong");
  EXPECT_EQ(Ask("POST", "/login", {}, {}, "password=wrong").code, 429u);
}

TEST_F(SiteTest, EachAnswerForbidsWhatOthersCouldDoWithIt) {
  for (const char* path : {"/", "/workers", "/jobs/1-hall", "/jobs/1-hall/log.txt", "/jobs/1-hall/rounds.csv",
                           "/jobs/1-hall/report", "/jobs/1-hall/picture", "/jobs/1-hall/files/map.h5",
                           "/events", "/page.js", "/nothing"}) {
    const HttpAnswer answer = Get(path);
    const std::string policy = HeaderOf(answer, "Content-Security-Policy");
    EXPECT_NE(policy.find("default-src '"), std::string::npos) << path;
    EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos) << path;
    EXPECT_EQ(policy.find("unsafe-inline") != std::string::npos, path == std::string("/jobs/1-hall/report"))
        << path;
    EXPECT_EQ(HeaderOf(answer, "X-Frame-Options"), "DENY") << path;
    EXPECT_EQ(HeaderOf(answer, "X-Content-Type-Options"), "nosniff") << path;
    EXPECT_EQ(HeaderOf(answer, "Cache-Control"), "no-store") << path;
    EXPECT_EQ(HeaderOf(answer, "Referrer-Policy"), "same-origin") << "by none a browser's form has no origin";
  }
  const std::string report = HeaderOf(Get("/jobs/1-hall/report"), "Content-Security-Policy");
  EXPECT_TRUE(report.starts_with("sandbox allow-scripts allow-downloads; default-src 'none'; ")) << report;
  for (const char* way_out :
       {"allow-same-origin", "connect-src", "'self'", "http", "*", "allow-top", "allow-popups"})
    EXPECT_EQ(report.find(way_out), std::string::npos) << "a report reaches what is not its own";
}

TEST_F(SiteTest, CommandsOfAnotherSitesPageAreRefused) {
  for (const auto& headers : std::vector<std::map<std::string, std::string>>{
           {},  // a form
           {{"x-cairn", "page"}, {"origin", "https://evil.example"}},
           {{"x-cairn", "page"}, {"origin", "null"}},
           {{"x-cairn", "page"}, {"sec-fetch-site", "cross-site"}},
           {{"x-cairn", "page"}, {"host", "evil.example:8080"}}})
    Ask("POST", "/jobs/1-hall/cancel", {}, headers);
  for (const char* method : {"GET", "HEAD", "PUT", "DELETE", "OPTIONS"})
    Ask(method, "/jobs/1-hall/cancel", {}, {{"x-cairn", "page"}});
  EXPECT_TRUE(source_->commands.empty());
  EXPECT_EQ(HeaderOf(Ask("OPTIONS", "/jobs/1-hall/cancel"), "Access-Control-Allow-Origin"), "");
  EXPECT_EQ(Get("/").code, 200u);
}

TEST_F(SiteTest, CommandsReachTheJobAndTheAnswerIsASentence) {
  EXPECT_EQ(Post("/jobs/1-hall/pause")["text"], "1-hall is paused.");
  EXPECT_EQ(Post("/jobs/1-hall/priority", "priority=-3")["ok"], true);
  source_->outcome = {false, "Cannot pause 1-hall: it is done."};
  EXPECT_EQ(Post("/jobs/1-hall/pause")["ok"], false);
  EXPECT_EQ(source_->commands,
            (std::vector<std::string>{"1-hall pause 0", "1-hall priority -3", "1-hall pause 0"}));
  for (const char* path : {"/jobs/1-hall/priority", "/jobs/1-hall/status", "/jobs/1-hall/results",
                           "/jobs/2-none/pause", "/jobs//pause", "/jobs/pause", "/pause", "/"})
    EXPECT_EQ(Post(path)["ok"], false) << path;
  EXPECT_EQ(Post("/jobs/1-hall/priority", "priority=3;x")["ok"], false);
  EXPECT_EQ(source_->commands.size(), 3u);
}

TEST_F(SiteTest, WhereItOnlyShowsNothingIsCommanded) {
  Make({.read_only = true});
  EXPECT_EQ(Get("/jobs/1-hall").body.find("data-action"), std::string::npos);
  for (const char* action : {"pause", "resume", "cancel", "retry", "delete", "priority"})
    EXPECT_EQ(Post("/jobs/1-hall/" + std::string(action), "priority=1")["ok"], false)
        << "guessed: " << action;
  EXPECT_TRUE(source_->commands.empty());
}

TEST_F(SiteTest, AJobThatTheKeyMayNotCommandHasNoButtons) {
  EXPECT_NE(Get("/jobs/1-hall").body.find("data-action"), std::string::npos);
  wire::JobInfo job = Hall();
  job.set_foreign(true);
  job.set_owner("desk<b>");
  Know({job});
  const std::string body = Get("/jobs/1-hall").body;
  EXPECT_EQ(body.find("data-action"), std::string::npos);
  EXPECT_NE(body.find("<dd>desk&lt;b&gt;</dd>"), std::string::npos) << "whose it is is said";
}

TEST_F(SiteTest, NoPathLeadsToAFileOrAJobThatIsNotOnTheList) {
  for (const char* path :
       {"/../../etc/passwd", "/jobs/../../etc/passwd", "/jobs/1-hall/../../../etc/passwd",
        "/jobs/1-hall/files/../said", "/jobs/1-hall/files//etc/passwd", "/jobs/1-hall/files/map.h5/..",
        "/jobs/1-hall/files/other.h5", "/jobs/1-hall/files/", "/jobs/2-none/files/map.h5", "/jobs/../report",
        "/jobs/%2e%2e/report", "/page.html", "/jobs/1-hall/said", "//"}) {
    const HttpAnswer answer = Get(path);
    EXPECT_EQ(answer.code, 404u) << path;
    EXPECT_TRUE(answer.file.empty()) << path;
  }
  EXPECT_EQ(Get("/jobs/1-hall/files/map.h5").file, "/cache/1/map.h5");
  EXPECT_EQ(Get("/jobs/1-hall/report").file, "/cache/1/report.html");
  EXPECT_EQ(Get("/jobs/1-hall/picture").file, "/cache/1/map.png");
  for (const std::string& fetched : source_->fetched) EXPECT_EQ(fetched, "1-hall 1");
}

TEST_F(SiteTest, JobsOnTheListAloneAreCompared) {
  wire::JobInfo other = Hall("other"), early = Hall("early");
  other.set_id("2-other");
  other.set_state("done");
  early.set_id("3-early");
  early.set_stage(0);
  Know({Hall(), other, early});
  const std::string body = Get("/jobs/1-hall").body;
  EXPECT_NE(body.find("<option value=\"2-other\">other</option>"), std::string::npos);
  EXPECT_EQ(body.find("<option value=\"3-early\">"), std::string::npos) << "it has no result";
  const auto compare = [this](const std::string& one, const std::string& with) {
    return Ask("GET", "/compare", {{"one", one}, {"other", with}, {"log", "../../etc/passwd"}});
  };
  const HttpAnswer page = compare("1-hall", "2-other");
  EXPECT_EQ(page.file, "/cache/1/comparison.html");
  EXPECT_TRUE(
      HeaderOf(page, "Content-Security-Policy").starts_with("sandbox allow-scripts allow-downloads;"));
  EXPECT_EQ(source_->fetched, std::vector<std::string>{"1-hall 1 beside 2-other 2"});
  for (const auto& [one, with] :
       std::vector<std::pair<std::string, std::string>>{{"1-hall", "1-hall"},
                                                        {"1-hall", "3-early"},
                                                        {"1-hall", "<script>alert(1)</script>"},
                                                        {"", ""},
                                                        {"../1-hall", "2-other"},
                                                        {"1-hall", "--out=x"}}) {
    const HttpAnswer refused = compare(one, with);
    EXPECT_EQ(refused.code, 404u) << with;
    EXPECT_EQ(refused.body.find("<script>alert"), std::string::npos);
  }
  EXPECT_EQ(source_->fetched.size(), 1u);
  source_->results = {.trouble = "They cannot be compared: <b>"};
  EXPECT_NE(compare("1-hall", "2-other").body.find("compared: &lt;b&gt;"), std::string::npos);
}

TEST_F(SiteTest, AHostileNameIsATextEverywhere) {
  const std::string evil = "<script>alert(1)</script>\"'><img src=x onerror=alert(2)>";
  wire::JobInfo job = Hall(evil, "failed");
  job.set_reason(evil);
  job.set_note(evil);
  job.set_stage_name(evil);
  job.add_failures(evil);
  Know({job});
  auto facts = std::make_shared<Facts>(*source_->facts);
  facts->workers.resize(1);
  facts->workers[0].set_name(evil);
  facts->workers[0].set_host(evil);
  facts->workers[0].set_state(evil);
  facts->workers[0].set_assigned(1);
  facts->workers[0].set_task(evil + ": " + evil);
  facts->times.Add(facts->workers, 1);
  facts->list->warning = facts->trouble = evil;
  facts->list->refused[evil] = 1;
  source_->facts = facts;
  auto history = std::make_shared<JobHistory>();
  wire::LogLine line;
  line.set_number(1);
  line.set_level(evil);
  line.set_text(evil);
  history->Add({line});
  source_->history = history;
  source_->results = {.trouble = evil};
  for (const char* path : {"/", "/workers", "/jobs/1-hall", "/jobs/1-hall/report", "/jobs/1-hall/picture",
                           "/jobs/<script>alert(1)"}) {
    const std::string body = Get(path).body;
    EXPECT_EQ(body.find("<script>alert"), std::string::npos) << path;
    EXPECT_EQ(body.find("<img src=x"), std::string::npos) << path;
    EXPECT_NE(body.find("&lt;script&gt;"), std::string::npos) << path;
  }
  const std::string searched = Ask("GET", "/", {{"q", evil}, {"state", evil}, {"page", evil}}).body;
  EXPECT_EQ(searched.find("<script>alert"), std::string::npos);
  EXPECT_EQ(searched.find("<img src=x"), std::string::npos);
}

TEST_F(SiteTest, PagesReadWithoutAScriptAndLoadNothingFromElsewhere) {
  const std::string jobs = Get("/").body;
  EXPECT_NE(jobs.find("<a href=\"/jobs/1-hall\">hall</a>"), std::string::npos);
  EXPECT_NE(jobs.find("<form id=\"filter\""), std::string::npos);
  for (const Asset& asset : Assets()) {
    EXPECT_FALSE(asset.bytes.empty()) << asset.name;
    EXPECT_EQ(asset.bytes.find("://") != std::string_view::npos, asset.name == "icon.svg")
        << "its name space";
  }
  for (const char* path : {"/", "/workers", "/jobs/1-hall"}) {
    const std::string body = Get(path).body;
    EXPECT_EQ(body.find("style="), std::string::npos) << "the policy forbids it";
    EXPECT_EQ(body.find("{{"), std::string::npos);
    EXPECT_EQ(body.find("onclick"), std::string::npos);
  }
}

TEST_F(SiteTest, AStreamSendsWhatHasChangedAlone) {
  const auto stream = Ask("GET", "/events", {{"for", "/jobs/1-hall"}}).stream;
  ASSERT_TRUE(stream);
  EXPECT_NE(stream->Next().find("event: parts\ndata: {"), std::string::npos);
  EXPECT_EQ(stream->Next(), "");
  wire::JobInfo job = Hall();
  job.set_note("iteration 2");
  Know({job});
  const std::string changed = stream->Next();
  EXPECT_NE(changed.find("iteration 2"), std::string::npos);
  EXPECT_EQ(changed.find("<h1>"), std::string::npos) << "the title has not changed";
  EXPECT_EQ(changed.substr(0, changed.size() - 1).find("\n\n"), std::string::npos)
      << "one event is one event";
  now_s_ += 11;
  EXPECT_EQ(stream->Next(), ": still here\n\n");
  EXPECT_EQ(source_->looks.back(), "1-hall") << "it is looked at as long as the stream lasts";
}

// In a frame, which no other site's page may be around.
TEST_F(SiteTest, TheMapSoFarOfAJobThatRunsIsShownAndReplaced) {
  EXPECT_EQ(Get("/jobs/1-hall").body.find("Map so far"), std::string::npos);
  EXPECT_EQ(Get("/jobs/1-hall/so-far").code, 404u);
  wire::JobInfo job = Hall();
  job.set_so_far("one");
  Know({job});
  const auto stream = Ask("GET", "/events", {{"for", "/jobs/1-hall"}}).stream;
  EXPECT_EQ(stream->Next().find("Map so far"), std::string::npos) << "it is not here yet";
  EXPECT_EQ(source_->fetched.back(), "1-hall so far one");
  source_->so_far = std::make_shared<FetchedResults>(
      FetchedResults{.folder = "/cache/7", .files = {.stages = {"map-so-far"}, .has_report = true}});
  EXPECT_NE(stream->Next().find("/jobs/1-hall/so-far?version=7"), std::string::npos);
  const HttpAnswer map = Get("/jobs/1-hall/so-far");
  EXPECT_EQ(map.file, "/cache/7/report.html");
  EXPECT_NE(HeaderOf(map, "Content-Security-Policy").find("sandbox allow-scripts"), std::string::npos);
  EXPECT_NE(HeaderOf(map, "Content-Security-Policy").find("frame-ancestors 'self'"), std::string::npos);
  EXPECT_EQ(HeaderOf(map, "X-Frame-Options"), "SAMEORIGIN");
  EXPECT_EQ(HeaderOf(Get("/jobs/1-hall"), "X-Frame-Options"), "DENY");
  source_->so_far = std::make_shared<FetchedResults>(FetchedResults{.folder = "/cache/8"});
  EXPECT_NE(stream->Next().find("/jobs/1-hall/so-far?version=8"), std::string::npos);
  Know({Hall("hall", "done")});
  EXPECT_EQ(Get("/jobs/1-hall").body.find("Map so far"), std::string::npos) << "its result is there";
}

TEST_F(SiteTest, APageThatWasJustSentIsWaitedForAtTheEnd) {
  Get("/jobs/1-hall");
  EXPECT_TRUE(site_->AwaitsListeners());
  const auto stream = Ask("GET", "/events", {{"for", "/jobs/1-hall"}}).stream;
  now_s_ += 1;
  Get("/workers");
  EXPECT_TRUE(site_->AwaitsListeners());
  now_s_ += 60;
  EXPECT_FALSE(site_->AwaitsListeners()) << "without a script it never listens";
  Get("/");
  Ask("GET", "/events", {{"for", "/"}});
  EXPECT_FALSE(site_->AwaitsListeners());
  site_->End("It is over.");
  const std::size_t looks = source_->looks.size();
  EXPECT_EQ(Get("/jobs/1-hall").code, 200u);
  EXPECT_EQ(source_->looks.size(), looks) << "who is gone is not asked";
  EXPECT_TRUE(site_->AwaitsListeners());
  EXPECT_NE(Ask("GET", "/events", {{"for", "/jobs/1-hall"}}).stream->Next().find("It is over."),
            std::string::npos);
}

TEST_F(SiteTest, OneWhoLooksOnTakesNotAllPlaces) {
  std::vector<std::shared_ptr<coordinator::HttpStream>> streams;
  for (int i = 0; i < 64; ++i) streams.push_back(Ask("GET", "/events", {{"for", "/"}}).stream);
  EXPECT_TRUE(streams.back());
  EXPECT_EQ(Ask("GET", "/events", {{"for", "/"}}).code, 503u);
  const std::string first = std::exchange(cookie_, "");
  const HttpAnswer welcome = Ask("GET", "/", {{"token", link_.substr(link_.find('=') + 1)}});
  cookie_ = HeaderOf(welcome, "Set-Cookie").substr(0, HeaderOf(welcome, "Set-Cookie").find(';'));
  EXPECT_TRUE(Ask("GET", "/events", {{"for", "/"}}).stream) << "another's places are his own";
  cookie_ = first;
  streams.pop_back();
  EXPECT_TRUE(Ask("GET", "/events", {{"for", "/"}}).stream) << "one is free again";
}

TEST_F(SiteTest, OneWhoSignsInAgainAndAgainLeavesPlacesToWhoComesNext) {
  std::vector<std::shared_ptr<coordinator::HttpStream>> streams;
  const auto look_on = [&] {
    streams.push_back(Ask("GET", "/events", {{"for", "/"}}).stream);
    if (!streams.back()) streams.pop_back();
    return streams.size();
  };
  const auto sign_in = [&] {
    cookie_.clear();
    const HttpAnswer welcome = Ask("GET", "/", {{"token", link_.substr(link_.find('=') + 1)}});
    cookie_ = HeaderOf(welcome, "Set-Cookie").substr(0, HeaderOf(welcome, "Set-Cookie").find(';'));
  };
  for (int session = 0; session < 6; ++session) {
    for (int i = 0; i < 70; ++i) look_on();
    sign_in();
  }
  EXPECT_EQ(streams.size(), 195U) << "three quarters, and one for each of three more sessions";
  EXPECT_EQ(look_on(), 196U) << "the seventh";
  EXPECT_EQ(look_on(), 196U) << "has one now";
}

TEST_F(SiteTest, ForFiftyWhoLookOnAPageIsMadeOnce) {
  std::vector<std::shared_ptr<coordinator::HttpStream>> streams;
  for (int i = 0; i < 50; ++i) streams.push_back(Ask("GET", "/events", {{"for", "/"}, {"q", "hall"}}).stream);
  std::string first = streams[0]->Next();
  for (const auto& stream : streams) EXPECT_TRUE(&stream == &streams[0] || stream->Next() == first);
  Know({});
  first = streams[0]->Next();
  EXPECT_NE(first.find("no jobs yet"), std::string::npos);
}

TEST_F(SiteTest, AJobThatIsDeletedAndACoordinatorThatIsGoneAreSaid) {
  const auto stream = Ask("GET", "/events", {{"for", "/jobs/1-hall"}}).stream;
  stream->Next();
  Know({Hall()}, "The coordinator does not answer.");
  const std::string lost = stream->Next();
  EXPECT_NE(lost.find("The coordinator does not answer."), std::string::npos);
  EXPECT_NE(lost.find("12:00:00 UTC"), std::string::npos) << "of when it is what is shown";
  EXPECT_NE(Get("/jobs/1-hall").body.find("<h1>hall</h1>"), std::string::npos) << "nothing is blank";
  Know({});
  EXPECT_NE(stream->Next().find("deleted"), std::string::npos);
  EXPECT_EQ(Get("/jobs/1-hall").code, 404u);
  EXPECT_EQ(Get("/jobs/1-hall/report").code, 404u);
}

TEST_F(SiteTest, BeforeTheFirstAnswerAPageSaysSo) {
  source_->facts = std::make_shared<Facts>();
  for (const char* path : {"/", "/workers", "/jobs/1-hall"}) {
    EXPECT_EQ(Get(path).code, 200u) << path;
    EXPECT_NE(Get(path).body.find("has not answered yet"), std::string::npos) << path;
  }
}

TEST_F(SiteTest, AtTheEndAStreamSaysWhyAndIsOver) {
  const auto stream = Ask("GET", "/events", {{"for", "/"}}).stream;
  stream->Next();
  EXPECT_FALSE(stream->is_over());
  site_->End("The run is over.");
  EXPECT_EQ(stream->Next(), "event: over\ndata: The run is over.\n\n");
  EXPECT_EQ(stream->Next(), "");
  EXPECT_TRUE(stream->is_over());
}

}  // namespace
}  // namespace cairn::page
