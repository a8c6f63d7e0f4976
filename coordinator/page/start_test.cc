// Starting a job from the pages: who may, what a form may say, and what is read without a script.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "coordinator/http/http_server.h"
#include "coordinator/http/testing/http_client.h"
#include "coordinator/page/testing/script.h"
#include "coordinator/page/testing/site_fixture.h"

namespace cairn::page {
namespace {

using coordinator::HttpAnswer;
using coordinator::HttpClient;
using coordinator::HttpRequest;

// Says of each file that it is a log of one robot with an evil name, plans and takes each job.
constexpr const char* kCairn = R"sh(case $1 in
  inspect) printf '%s' '{"kind": "log", "facts": {"robot <script>alert(1)</script>": "12 controls"},
    "unit_doubts": ["3 m is far"], "datasets": [{"name": "robot/0/odometry/time_s", "shape": [12],
    "type": "float64", "unit": "s", "low": 0, "high": 11}]}';;
  pipelines) printf '%s' '[{"name": "landmark_map", "summary": "maps", "inputs": [{"name": "log", "optional": false},
    {"name": "map", "optional": true}], "options": [
    {"name": "cell_m", "type": "real", "unit": "m", "default": "0.25", "help": "edge of a cell", "low": 0.01, "high": 10},
    {"name": "refine", "type": "boolean", "unit": "", "default": "true", "help": "refines <b>it"},
    {"name": "mode", "type": "text", "unit": "", "default": "fast", "help": "", "choices": ["fast", "exact"]}]},
    {"name": "ball", "summary": "learns", "inputs": [{"name": "samples", "optional": false}], "options": []}]';;
  run) printf '%s' '{"note": "36 tasks, about 2 min", "expected": {"seconds": 125, "memory_mb": 70.5, "odd": 3},
    "inputs": {"log": {"what": "1 robot, 12 controls"}}}';;
  submit) if grep -q refuse "$BASE/refuse" 2>/dev/null; then echo "cairn: --set cell_m=9: <a number>" >&2; exit 2; fi
    printf '%s' '{"id": "7-hall"}';;
esac)sh";

class StartTest : public SiteFixture {
 protected:
  StartTest() {
    script_.Does(kCairn);
    Serve();
  }
  ~StartTest() override { site_.reset(); }
  void Serve(bool read_only = false) {
    site_.reset();
    desk_ = std::make_unique<Desk>(DeskOptions{.program = script_.program(),
                                               .service = {"--connect=ipc:///x/y"},
                                               .folder = script_.base() / "cache",
                                               .most_bytes = 100'000});
    Make({.read_only = read_only, .desk = desk_.get()});
    const std::string form = Get("/new").body, mark = "/new/upload?token=";
    const std::size_t at = form.find(mark);
    token_ =
        at == std::string::npos ? "" : form.substr(at + mark.size(), form.find('"', at) - at - mark.size());
  }
  // As the server does it; the answer to the whole.
  HttpAnswer Bring(const std::string& name, const std::string& bytes,
                   std::map<std::string, std::string> headers = {}) {
    HttpRequest request{
        .method = "POST", .path = "/new/upload", .query = {{"token", token_}}, .headers = headers};
    request.headers.try_emplace("host", "127.0.0.1:8080");
    request.headers.try_emplace("cookie", cookie_);
    auto begun = site_->BeginUpload(request);
    if (auto* refusal = std::get_if<HttpAnswer>(&begun)) return *refusal;
    request.upload = std::get<std::shared_ptr<coordinator::HttpUpload>>(begun);
    request.upload->Take("file", name, 0, bytes);
    const auto reply = std::make_shared<Kept>();
    site_->Answer(request, reply);
    return reply->Wait();
  }
  std::string Bring() { return HeaderOf(Bring("hall.h5", "bytes"), "Location"); }
  HttpAnswer Send(const std::string& path, const std::string& body) {
    return Ask("POST", path, {}, {}, "token=" + token_ + "&" + body);
  }

  Script script_;
  std::unique_ptr<Desk> desk_;
  std::string token_;
};

TEST_F(StartTest, FromAFileToAJobWithFormsAlone) {
  EXPECT_NE(Get("/").body.find("href=\"/new\""), std::string::npos);
  const HttpAnswer brought = Bring("hall.h5", "bytes");
  EXPECT_EQ(brought.code, 303u) << "or loading it again would send it again";
  const std::string file = HeaderOf(brought, "Location"), seen = Get(file).body;
  EXPECT_NE(seen.find("12 controls"), std::string::npos);
  EXPECT_NE(seen.find("3 m is far"), std::string::npos);
  EXPECT_NE(seen.find("robot/0/odometry/time_s"), std::string::npos);
  EXPECT_NE(seen.find(file + "/landmark_map\""), std::string::npos);
  EXPECT_EQ(seen.find("ball"), std::string::npos) << "that reads no log";
  const std::string form = Get(file + "/landmark_map").body;
  for (const char* part :
       {"name=\"set.cell_m\"", "min=\"0.01\" max=\"10\"", "default 0.25 m; 0.01", "edge of a cell",
        "placeholder=\"0.25\"", "<option value=\"\" selected>default: true</option>",
        "<option value=\"exact\">exact</option>", "refines &lt;b&gt;it", "name=\"input.map\"",
        "name=\"units_are_right\""})
    EXPECT_NE(form.find(part), std::string::npos) << part << "\n" << form;
  const std::string order =
      "do=plan&name=a+%26+b&seed=7&priority=2&set.cell_m=0.5&set.refine=&set.mode=exact";
  const HttpAnswer planned = Send(file + "/landmark_map", order);
  EXPECT_EQ(planned.code, 200u);
  for (const char* part :
       {"36 tasks, about 2 min", "2:05 min:s", "70.5 MB", "1 robot, 12 controls", "value=\"0.5\"",
        "<option value=\"exact\" selected>", "value=\"a &amp; b\"", "value=\"7\""})
    EXPECT_NE(planned.body.find(part), std::string::npos) << part << "\n" << planned.body;
  EXPECT_NE(
      script_.Words().find("run --dry-run --json --seed=7 --name=a & b --set=cell_m=0.5 --set=mode=exact -- "
                           "landmark_map "),
      std::string::npos)
      << script_.Words();
  const HttpAnswer submitted =
      Send(file + "/landmark_map", order.substr(order.find('&') + 1) + "&do=submit&units_are_right=1");
  EXPECT_EQ(submitted.code, 303u);
  EXPECT_EQ(HeaderOf(submitted, "Location"), "/jobs/7-hall");
  EXPECT_NE(script_.Words().find("submit --priority=2 --connect=ipc:///x/y --json --seed=7"),
            std::string::npos);
  EXPECT_NE(script_.Words().find("--units-are-right"), std::string::npos);
}

TEST_F(StartTest, WhatIsRefusedIsASentenceAndTheFormKeepsWhatItHad) {
  const std::string file = Bring();
  std::ofstream(script_.base() / "refuse") << "refuse";
  const HttpAnswer refused = Send(file + "/landmark_map", "do=submit&set.cell_m=9");
  EXPECT_EQ(refused.code, 400u);
  EXPECT_NE(refused.body.find("--set cell_m=9: &lt;a number&gt;"), std::string::npos);
  EXPECT_NE(refused.body.find("value=\"9\""), std::string::npos);
}

TEST_F(StartTest, OnlyAKeyThatMaySubmitStartsAJob) {
  const std::string file = Bring();
  may_submit_ = false;
  Know({Hall()});
  EXPECT_EQ(Get("/").body.find("href=\"/new\""), std::string::npos);
  for (const std::string& path : {std::string("/new"), file, file + "/landmark_map"})
    EXPECT_EQ(Get(path).code, 403u) << path;
  script_.Forget();
  EXPECT_EQ(Bring("hall.h5", "bytes").code, 403u);
  EXPECT_EQ(Send(file + "/landmark_map", "do=submit").code, 403u);
  EXPECT_EQ(Send(file + "/remove", "").code, 403u);
  may_submit_ = true;
  Know({Hall()});
  Serve(true);
  EXPECT_EQ(Get("/new").code, 403u) << "--read-only";
  EXPECT_EQ(Bring("hall.h5", "bytes").code, 403u);
  EXPECT_EQ(script_.Words(), "");
}

TEST_F(StartTest, AFormOfAnotherSiteOrOfNobodyIsRefusedBeforeItsFileComes) {
  const std::string file = Bring();
  script_.Forget();
  const std::string right = token_;
  for (const std::string& wrong : {std::string(), std::string("guessed"), right.substr(1), right + "0"}) {
    token_ = wrong;
    EXPECT_EQ(Bring("hall.h5", "bytes").code, 403u) << wrong;
    EXPECT_EQ(Send(file + "/landmark_map", "do=submit").code, 403u) << wrong;
    EXPECT_EQ(Send(file + "/remove", "").code, 403u) << wrong;
    EXPECT_EQ(Send("/new/from-job", "job=1-hall&what=inputs").code, 403u) << wrong;
  }
  token_ = right;
  for (const auto& headers :
       std::vector<std::map<std::string, std::string>>{{{"origin", "https://evil.example"}},
                                                       {{"origin", "http://127.0.0.1:9"}},
                                                       {{"sec-fetch-site", "same-site"}},
                                                       {{"host", "evil.example:8080"}},
                                                       {{"cookie", ""}}}) {
    EXPECT_EQ(Bring("hall.h5", "bytes", headers).code, 403u);
    EXPECT_NE(Ask("POST", file + "/landmark_map", {}, headers, "do=submit&token=" + token_).code, 303u);
  }
  EXPECT_EQ(Ask("POST", file + "/landmark_map", {}, {{"x-cairn", "page"}}, "do=submit").code, 403u);
  EXPECT_EQ(script_.Words(), "");
  EXPECT_EQ(desk_->Files().size(), 1u);
  cookie_ = "";
  EXPECT_EQ(Get("/new").code, 401u);
}

TEST_F(StartTest, AnotherJobGivesItsFilesAndWhyNotIsASentence) {
  EXPECT_NE(
      Ask("GET", "/new", {{"job", "3-hall\"><script>"}}).body.find("value=\"3-hall&quot;&gt;&lt;script"),
      std::string::npos);
  const HttpAnswer nothing = Send("/new/from-job", "job=3-hall&what=inputs");
  EXPECT_EQ(nothing.code, 400u);
  EXPECT_NE(nothing.body.find("There is nothing of it to take."), std::string::npos);
  EXPECT_NE(script_.Words().find(" --inputs --connect=ipc:///x/y -- 3-hall\n"), std::string::npos);
  script_.Does("case $1 in results) mkdir \"${2#--out=}\"; echo >\"${2#--out=}/log.h5\";; esac\n" +
               std::string(kCairn));
  const HttpAnswer brought = Send("/new/from-job", "job=3-hall&what=results");
  EXPECT_EQ(brought.code, 303u);
  EXPECT_NE(Get(HeaderOf(brought, "Location")).body.find("3-hall-log.h5"), std::string::npos);
}

TEST_F(StartTest, TwoWhoLookOnHaveFormsOfTheirOwn) {
  const std::string first = token_;
  const HttpAnswer welcome =
      Ask("GET", "/", {{"token", link_.substr(link_.find('=') + 1)}}, {{"cookie", ""}});
  cookie_ = HeaderOf(welcome, "Set-Cookie").substr(0, HeaderOf(welcome, "Set-Cookie").find(';'));
  EXPECT_EQ(Bring("hall.h5", "bytes").code, 403u) << "another's token";
}

TEST_F(StartTest, NoPathOrNameLeadsElsewhereOrIsRun) {
  const std::string file = Bring();
  for (const std::string& path :
       {file + "/../../etc/passwd", file + "/ball.yaml", std::string("/new/0"), std::string("/new/-1"),
        std::string("/new/99999999999999999999"), std::string("/new/1x"), std::string("/new/upload"),
        std::string("/new//"), file + "/<script>"}) {
    EXPECT_EQ(Get(path).code, 404u) << path;
    EXPECT_EQ(Send(path, "do=submit").code, path == "/new/upload" ? 403u : 404u) << path;
  }
  EXPECT_EQ(script_.Words().find("submit"), std::string::npos);
  EXPECT_EQ(Get(file).body.find("<script>alert"), std::string::npos);
  Bring("<img src=x onerror=alert(1)>.h5", "bytes");
  EXPECT_EQ(Get("/new").body.find("<img src=x"), std::string::npos);
  const HttpAnswer planned =
      Send(file + "/landmark_map", "do=plan&name=%22%3E%3Cscript%3Ealert(2)&set.x%22%3E%3Cb=1");
  EXPECT_EQ(planned.body.find("<script>alert"), std::string::npos);
  for (const auto* name : {"Content-Security-Policy", "X-Frame-Options", "Cache-Control"})
    EXPECT_NE(HeaderOf(planned, name), "") << name;
}

// `--input=NAME=FILE`: a '=' in the name would make another file of the rest.
TEST_F(StartTest, AFormNamesInputsAndOptionsOfThePipelineAlone) {
  const std::string file = Bring(), number = file.substr(5);
  Send(file + "/landmark_map", "do=plan&input.map%3D%2Ftmp%2Fx=" + number + "&input.none=" + number +
                                   "&set.none=1&set.cell_m%3D1=2&input.map=" + number);
  EXPECT_TRUE(script_.Words().ends_with("run --dry-run --json --seed=0 --input=map=" + number +
                                        "/hall.h5 -- landmark_map " + number + "/hall.h5\n"))
      << script_.Words();
}

TEST_F(StartTest, ResultsAreComparedByTheTruthOfAFileThatWasBrought) {
  const std::string number = Bring().substr(5);
  wire::JobInfo other = Hall("other");
  other.set_id("2-other");
  Know({Hall(), other});
  EXPECT_NE(Get("/jobs/1-hall").body.find("<option value=\"" + number + "\">hall.h5</option>"),
            std::string::npos);
  Ask("GET", "/compare", {{"one", "1-hall"}, {"other", "2-other"}, {"log", number}});
  ASSERT_EQ(source_->fetched.size(), 1u);
  EXPECT_TRUE(source_->fetched[0].starts_with("1-hall 1 beside 2-other 1 with " + script_.base().string()));
  EXPECT_TRUE(source_->fetched[0].ends_with("/files/" + number + "/hall.h5"));
  for (const char* none : {"0", "99", "-1", "../1", "1/../1"})
    EXPECT_EQ(Ask("GET", "/compare", {{"one", "1-hall"}, {"other", "2-other"}, {"log", none}}).code, 404u)
        << none;
  EXPECT_EQ(source_->fetched.size(), 1u);
}

TEST_F(StartTest, AFileThatIsGoneIsSaid) {
  const std::string file = Bring();
  EXPECT_EQ(HeaderOf(Send(file + "/remove", ""), "Location"), "/new");
  EXPECT_NE(Get(file).body.find("not here any more"), std::string::npos);
  EXPECT_NE(Send(file + "/landmark_map", "do=submit").body.find("not here any more"), std::string::npos);
  EXPECT_NE(Bring("a.h5", "").body.find("No file was chosen"), std::string::npos);
}

// Over a real port, as a browser sends it.
class UploadTest : public StartTest {
 protected:
  void Listen(const coordinator::HttpLimits& limits) {
    server_.reset();  // of two in a process the one that ends first would take the other's sockets along
    server_ =
        coordinator::HttpServer::Listen(
            "0", "a test", limits,
            [this](const HttpRequest& request, const auto& reply) { site_->Answer(AsOurs(request), reply); },
            [this](const HttpRequest& request) { return site_->BeginUpload(AsOurs(request)); })
            .value();
  }
  HttpRequest AsOurs(HttpRequest request) const {
    request.headers["host"] = "127.0.0.1:8080";
    return request;
  }
  ~UploadTest() override { server_.reset(); }
  std::string Head(std::size_t length, const std::string& token) const {
    return "POST /new/upload?token=" + token + " HTTP/1.1\r\nHost: h\r\nCookie: " + cookie_ +
           "\r\nContent-Type: multipart/form-data; boundary=edge\r\nContent-Length: " +
           std::to_string(length) + "\r\nConnection: close\r\n\r\n";
  }
  static std::string Form(const std::string& file) {
    return "--edge\r\nContent-Disposition: form-data; name=\"file\"; "
           "filename=\"../hall.h5\"\r\nContent-Type: "
           "application/octet-stream\r\n\r\n" +
           file + "\r\n--edge--\r\n";
  }
  std::string Say(const std::string& all) const {
    const HttpClient client(server_->address());
    client.Say(all);
    return client.HearAll();
  }

  std::size_t FilesHere() const {
    std::size_t files = 0;
    std::error_code gone;  // meanwhile
    for (std::filesystem::recursive_directory_iterator it(script_.base() / "cache", gone), end;
         !gone && it != end; it.increment(gone))
      files += it->path().filename() == "hall.h5" ? 1 : 0;
    return files;
  }

  std::unique_ptr<coordinator::HttpServer> server_;
};

TEST_F(UploadTest, ComesInPiecesAndIsWhole) {
  Listen({.body_bytes = 100, .upload_bytes = 200'000});
  std::string bytes;
  for (int i = 0; i < 50'000; ++i) bytes += static_cast<char>(i * 7);
  bytes.replace(20'000, 8, "\r\n--edgy");
  const std::string form = Form(bytes);
  const HttpClient client(server_->address());
  client.Say(Head(form.size(), token_));
  for (std::size_t at = 0; at < form.size(); at += 997) client.Say(form.substr(at, 997));
  const std::string answer = client.HearAll();
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 303 ")) << answer;
  ASSERT_EQ(desk_->Files().size(), 1u);
  std::string kept;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(script_.base() / "cache"))
    if (entry.path().filename() == "hall.h5") {
      std::stringstream text;
      text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
      kept = text.str();
    }
  EXPECT_TRUE(kept == bytes) << kept.size();
}

TEST_F(UploadTest, OneThatIsTooLargeIsToldSoAfterItCameAndAMonsterAtOnce) {
  Listen({.body_bytes = 100, .upload_bytes = 200'000});
  const std::string form = Form(std::string(150'000, 'x'));
  const std::string answer = Say(Head(form.size(), token_) + form);
  EXPECT_NE(answer.find("There is room for"), std::string::npos) << answer;
  EXPECT_TRUE(Say(Head(1'000'000'000'000, token_)).starts_with("HTTP/1.1 413 "));
  EXPECT_TRUE(Say(Head(form.size(), "guessed")).starts_with("HTTP/1.1 403 ")) << "before it comes";
  EXPECT_TRUE(desk_->Files().empty());
}

TEST_F(UploadTest, TwoFilesAreNotJoined) {
  Listen({.body_bytes = 100, .upload_bytes = 200'000});
  const std::string end = "--edge--\r\n";
  for (const std::string& first : {std::string("one"), std::string(50'000, 'x')}) {
    std::string two = Form(first);
    two.erase(two.size() - end.size());
    two += Form("two");
    EXPECT_NE(Say(Head(two.size(), token_) + two).find("bring each on its own"), std::string::npos);
  }
  EXPECT_TRUE(desk_->Files().empty());
  EXPECT_EQ(FilesHere(), 0u);
}

TEST_F(UploadTest, OneThatBreaksOffOrIsNoFormLeavesNothing) {
  Listen({.body_bytes = 100, .upload_bytes = 200'000});
  const std::string form = Form(std::string(1000, 'x'));
  {
    const HttpClient gone(server_->address());
    gone.Say(Head(form.size(), token_) + form.substr(0, form.size() / 2));
    while (FilesHere() == 0) std::this_thread::yield();
  }
  while (FilesHere() > 0) std::this_thread::yield();
  const std::string cut = form.substr(0, form.size() - 20);  // it ends before its edge
  EXPECT_NE(Say(Head(cut.size(), token_) + cut).find("did not come whole"), std::string::npos);
  Say(Head(7, token_) + "rubbish");
  EXPECT_TRUE(desk_->Files().empty());
  EXPECT_EQ(FilesHere(), 0u);
}

// Byte by byte for ever: it holds no place. Fast enough for any body is not yet fast enough for an upload.
TEST_F(UploadTest, OneThatComesTooSlowlyIsCutOff) {
  for (const coordinator::HttpLimits& limits :
       {coordinator::HttpLimits{
            .silent_s = 1, .body_bytes = 100, .upload_bytes = 200'000, .slowest = 1'000'000},
        coordinator::HttpLimits{.silent_s = 3600,
                                .body_bytes = 100,
                                .upload_bytes = 200'000,
                                .upload_patience_s = 1,
                                .upload_slowest = 1'000'000}}) {
    Listen(limits);
    const std::string form = Form(std::string(100'000, 'x'));
    const HttpClient slow(server_->address());
    slow.Say(Head(form.size(), token_));
    std::size_t sent = 0;
    while (sent < form.size() && slow.Say(form.substr(sent, 1))) {
      ++sent;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_LT(sent, form.size());
    while (FilesHere() > 0) std::this_thread::yield();
    const std::string next = Say(Head(Form("x").size(), token_) + Form("x"));
    EXPECT_TRUE(next.starts_with("HTTP/1.1 303 ")) << next;
    desk_->Remove(desk_->Files().back().number);
  }
}

}  // namespace
}  // namespace cairn::page
