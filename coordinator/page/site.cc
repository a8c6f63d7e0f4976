#include "coordinator/page/site.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "coordinator/page/answers.h"
#include "coordinator/page/assets.h"
#include "coordinator/page/html.h"

namespace cairn::page {
namespace {

using coordinator::HttpAnswer;
using coordinator::HttpRequest;

constexpr double kSignOfLife_s = 10;
constexpr double kListens_s = 8;  // after it was asked for a page does, at the latest
constexpr std::size_t kMostMade = 256;
constexpr long kMostOfASession = 64;  // streams
constexpr long kKept = 64;            // the last of all: for sessions that have none

// In place of a picture that there is not.
HttpAnswer SentenceAsPicture(const std::string& text) {
  return WithHeaders(
      {.body = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 60\" width=\"720\" "
               "height=\"60\"><rect width=\"720\" height=\"60\" fill=\"#fff\"/><text x=\"16\" y=\"36\" "
               "fill=\"#17212b\" font-family=\"sans-serif\" font-size=\"15\">" +
               Text(text) + "</text></svg>",
       .type = "image/svg+xml"});
}

View ViewOf(const std::string& path, const HttpRequest& request) {
  if (path == "/workers") return {.kind = View::Kind::kWorkers};
  const std::string jobs = "/jobs/";
  if (path.starts_with(jobs)) return {.kind = View::Kind::kJob, .job = path.substr(jobs.size())};
  View view{.search = request.Query("q").substr(0, 200), .state = request.Query("state").substr(0, 20)};
  const std::string page = request.Query("page");
  std::from_chars(page.data(), page.data() + page.size(), view.page);
  view.page = std::clamp<std::uint64_t>(view.page, 1, 1'000'000);
  return view;
}

std::string EventsOf(const View& view) {
  const std::string address = view.Address();
  if (view.kind != View::Kind::kJobs) return "/events?for=" + address;
  return "/events?for=/" + (address.size() > 1 ? "&" + address.substr(2) : "");
}

// "event: parts\ndata: {…}\n\n"
std::string EventText(const char* event, const std::string& data) {
  std::string text = std::string("event: ") + event + "\ndata: ";
  for (const char c : data) text += c == '\n' ? ' ' : c;
  return text + "\n\n";
}

std::string LoginForm(const std::string& why) {
  return (why.empty() ? "" : "<p class=\"advice bad\">" + Text(why) + "</p>\n") +
         "<form class=\"login\" method=\"post\" action=\"/login\">\n<label>Password <input type=\"password\" "
         "name=\"password\" autocomplete=\"current-password\" required autofocus></label>\n"
         "<button>Sign in</button>\n</form>\n";
}

// The cookie is sent to no page that another site's link leads to, so this one leads there.
HttpAnswer Welcome(const std::string& cookie) {
  HttpAnswer answer = Sentence(200, "Signed in", "<p><a href=\"/\">To the jobs</a></p>");
  const std::string head = "<head>";
  answer.body.insert(answer.body.find(head) + head.size(),
                     "<meta http-equiv=\"refresh\" content=\"0;url=/\">");
  answer.headers.emplace_back("Set-Cookie", cookie);
  return answer;
}

}  // namespace

// Sends of a page what has changed since it was sent.
class PartsStream : public coordinator::HttpStream {
 public:
  PartsStream(std::shared_ptr<Site> site, View view, std::shared_ptr<int> seat)
      : site_(std::move(site)), view_(std::move(view)), seat_(std::move(seat)) {}

  std::string Next() override {
    if (over_) return "";
    if (const std::string farewell = site_->Farewell(); !farewell.empty()) {
      over_ = true;
      return EventText("over", farewell);
    }
    site_->source_->Look(view_.job, nullptr);
    const double now_s = site_->now_s_();
    const std::shared_ptr<const Parts> parts = site_->PartsFor(view_);
    nlohmann::json changed = nlohmann::json::object(), order = nlohmann::json::array();
    for (const auto& [id, html] : *parts) {
      order.push_back(id);
      const std::size_t hash = std::hash<std::string>()(html);
      if (const auto [sent, first] = sent_.try_emplace(id, hash); first || sent->second != hash) {
        sent->second = hash;
        changed[id] = html;
      }
    }
    if (changed.empty() && order == order_) {
      if (now_s - said_s_ < kSignOfLife_s) return "";
      said_s_ = now_s;
      return ": still here\n\n";
    }
    order_ = order;
    said_s_ = now_s;
    const nlohmann::json event = {{"order", order}, {"parts", changed}};
    return EventText("parts", event.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  bool is_over() const override { return over_; }

 private:
  std::shared_ptr<Site> site_;
  View view_;
  std::shared_ptr<int> seat_;  // held while it lasts
  std::map<std::string, std::size_t> sent_;
  nlohmann::json order_;
  double said_s_ = 0;
  bool over_ = false;
};

Site::Site(SiteOptions options, Entrance entrance, std::shared_ptr<Source> source,
           std::function<double()> now_s)
    : options_(std::move(options)),
      entrance_(std::move(entrance)),
      source_(std::move(source)),
      now_s_(std::move(now_s)),
      start_(options_.desk == nullptr ? nullptr
                                      : std::make_shared<StartPages>(options_.desk, options_.foot)) {}

void Site::End(const std::string& why) {
  const std::lock_guard lock(mutex_);
  farewell_ = why;
}

bool Site::AwaitsListeners() {
  const std::lock_guard lock(mutex_);
  std::erase_if(awaited_, [now_s = now_s_()](const auto& of) { return now_s - of.second > kListens_s; });
  return !awaited_.empty();
}

// At the end the coordinator of a run is gone, which would be waited for.
void Site::LookUnlessOver(const std::string& job, std::function<void()> then) {
  if (!Farewell().empty()) return then();
  source_->Look(job, std::move(then));
}

// One without a script never listens.
void Site::NotePage(const HttpRequest& request) {
  AwaitsListeners();
  const std::lock_guard lock(mutex_);
  if (awaited_.size() >= kMostMade) awaited_.erase(awaited_.begin());
  awaited_.emplace_back(entrance_.FormToken(request), now_s_());
}

void Site::NoteListener(const HttpRequest& request) {
  const std::lock_guard lock(mutex_);
  const std::string token = entrance_.FormToken(request);
  const auto page = std::ranges::find(awaited_, token, [](const auto& of) { return of.first; });
  if (page != awaited_.end()) awaited_.erase(page);
}

std::string Site::Farewell() {
  const std::lock_guard lock(mutex_);
  return farewell_;
}

void Site::Answer(const HttpRequest& request, const Reply& reply) {
  if (const std::string wrong = entrance_.WhatIsWrongWithHost(request); !wrong.empty())
    return reply->Send(Sentence(421, "Another address", "<p>" + Text(wrong) + ".</p>"));
  const bool reads = request.method == "GET" || request.method == "HEAD";
  if (!reads && request.method != "POST") {
    HttpAnswer refusal = Sentence(405, "Not so", "<p>GET and POST alone.</p>");
    refusal.headers.emplace_back("Allow", "GET, HEAD, POST");
    return reply->Send(std::move(refusal));
  }
  for (const Asset& asset : Assets())
    if (reads && request.path == "/" + std::string(asset.name) && asset.name != "page.html")
      return reply->Send(WithHeaders({.body = std::string(asset.bytes), .type = std::string(asset.type)}));
  if (!reads && !entrance_.IsOurOwn(request))
    return reply->Send(Sentence(403, "Not from here", "<p>Another site's page sent this.</p>"));
  if (!entrance_.Knows(request, now_s_())) return AnswerStranger(request, reply);
  if (!reads) return AnswerPost(request, reply);
  AnswerGet(request, reply);
}

std::string Site::WhyNoStart() const {
  if (!start_ || options_.read_only) return "This page shows jobs, and starts none.";
  const FactsPtr facts = source_->Latest();
  if (!facts->known) return "The coordinator has not answered yet: load this page again.";
  return facts->list->may_submit ? "" : "This page’s key may look on, and start no job.";
}

std::variant<std::shared_ptr<coordinator::HttpUpload>, HttpAnswer> Site::BeginUpload(
    const HttpRequest& request) {
  const auto refused = [](unsigned code, const std::string& why) {
    return Sentence(code, "Not so", "<p>" + Text(why) + "</p>");
  };
  if (!entrance_.WhatIsWrongWithHost(request).empty() || !entrance_.IsOurOwn(request) ||
      !entrance_.Knows(request, now_s_()) || !entrance_.IsFormToken(request, request.Query("token")))
    return refused(403, "No page of these sent this.");
  if (request.path != "/new/upload") return refused(404, "No file goes there.");
  if (const std::string why = WhyNoStart(); !why.empty()) return refused(403, why);
  return start_->Begin(request);
}

// Forms, which have no header of ours, but the token of his pages.
void Site::AnswerStart(const HttpRequest& request, const Reply& reply) {
  const std::string token = entrance_.FormToken(request);
  const bool posts = request.method == "POST";
  const auto in_form = [&] { return FormValues(request.body)["token"]; };
  if (posts &&
      !entrance_.IsFormToken(request, request.path == "/new/upload" ? request.Query("token") : in_form()))
    return reply->Send(Sentence(403, "Not from here", "<p>No page of these sent this.</p>"));
  source_->Look("", [self = shared_from_this(), posts, request, token, reply] {
    if (const std::string why = self->WhyNoStart(); !why.empty())
      return reply->Send(Sentence(403, "Not here", "<p>" + Text(why) + " <a href=\"/\">All jobs</a></p>"));
    if (posts) return self->start_->Post(request, token, reply);
    self->start_->Get(request, token, reply);
  });
}

void Site::AnswerStranger(const HttpRequest& request, const Reply& reply) {
  const std::string token = request.Query("token");
  if (request.path == "/" && !token.empty())
    if (const auto cookie = entrance_.TakeToken(token, now_s_())) return reply->Send(Welcome(*cookie));
  std::string why = token.empty() ? "" : "this link was used already, or is of an earlier start";
  if (request.path == "/login" && request.method == "POST") {
    const Result<std::string> cookie = entrance_.TakePassword(FormValues(request.body)["password"], now_s_());
    if (cookie.ok()) return reply->Send(Welcome(cookie.value()));
    why = cookie.status().message();
    return reply->Send(
        Sentence(cookie.status().code() == Code::kBusy ? 429 : 401, "Not let in", LoginForm(why)));
  }
  std::string html =
      "<p>" + (why.empty() ? "" : Text(why) + ". ") +
      "Open the link that “cairn page” printed where it was started: each works once, and then it prints "
      "the next.</p>\n";
  if (entrance_.has_password()) html += LoginForm("");
  reply->Send(Sentence(401, "Not let in", html));
}

void Site::AnswerGet(const HttpRequest& request, const Reply& reply) {
  const std::string& path = request.path;
  if (path == "/events") return AnswerEvents(request, reply);
  if (path == "/compare") return AnswerComparison(request, reply);
  if (path == "/new" || path.starts_with("/new/")) return AnswerStart(request, reply);
  if (path == "/" || path == "/workers") {
    NotePage(request);
    LookUnlessOver("", [self = shared_from_this(), view = ViewOf(path, request), reply] {
      reply->Send(self->PageOf(view));
    });
    return;
  }
  const std::string jobs = "/jobs/";
  if (!path.starts_with(jobs)) return reply->Send(NotHere());
  const std::string rest = path.substr(jobs.size());
  const std::size_t slash = std::min(rest.find('/'), rest.size());
  if (slash == rest.size()) NotePage(request);
  AnswerJob(rest.substr(0, slash), rest.substr(slash), reply);
}

// Nothing but what is on the list of jobs leads any further, to a file or to the coordinator.
void Site::AnswerJob(const std::string& job, const std::string& what, const Reply& reply) {
  LookUnlessOver(job, [self = shared_from_this(), job, what, reply] {
    if (what.empty()) return reply->Send(self->PageOf({.kind = View::Kind::kJob, .job = job}));
    const FactsPtr facts = self->source_->Latest();
    const wire::JobInfo* info = facts->Find(job);
    if (info == nullptr) return reply->Send(NotHere());
    if (what == "/so-far") return self->AnswerSoFar(*info, reply);
    const HistoryPtr history = self->source_->HistoryOf(*info);
    if (what == "/rounds.csv")
      return reply->Send(
          WithHeaders({.body = RoundsCsv(history ? history->rounds() : std::vector<RoundLine>()),
                       .type = "text/csv; charset=utf-8"}));
    if (what != "/log.txt") return self->AnswerFile(*info, what, reply);
    std::string text;
    if (history)
      for (const wire::LogLine& line : history->lines())
        text += line.utc() + "  " + (line.level() == "info" ? "" : line.level() + ": ") + line.text() + "\n";
    reply->Send(WithHeaders({.body = std::move(text)}));
  });
}

// By what forms say: ids of jobs on the list, and a file that was brought.
void Site::AnswerComparison(const HttpRequest& request, const Reply& reply) {
  source_->Look("", [self = shared_from_this(), request, reply] {
    const FactsPtr facts = self->source_->Latest();
    const wire::JobInfo *one = facts->Find(request.Query("one")),
                        *other = facts->Find(request.Query("other"));
    const auto refuse = [reply](const std::string& why) {
      reply->Send(Sentence(404, "Nothing to compare", "<p>" + Text(why) + " <a href=\"/\">All jobs</a></p>"));
    };
    if (one == nullptr || other == nullptr)
      return refuse("There is no job “" + request.Query(one == nullptr ? "one" : "other") + "” any more.");
    if (one == other) return refuse("Both are the same job.");
    for (const wire::JobInfo* job : {one, other})
      if (StagesDone(*job) == 0) return refuse(job->id() + " has no result yet.");
    Compared what{ResultsNow(*one), ResultsNow(*other)};
    if (const std::string file = request.Query("log"); !file.empty() && self->options_.desk != nullptr) {
      what.log = self->options_.desk->WhereIs(file);
      if (what.log.empty()) return refuse("That file is not here any more: bring it again.");
    }
    self->source_->Compare(what, [refuse, reply](const FetchedResults& made) {
      if (!made.trouble.empty()) return refuse(made.trouble);
      reply->Send(WithHeaders({.type = kHtml, .file = made.folder / kComparison}, kReportPolicy));
    });
  });
}

// What is shown is the one that is there, whatever version a page asks for.
void Site::AnswerSoFar(const wire::JobInfo& job, const Reply& reply) {
  const auto so_far = source_->SoFar(job);
  if (!so_far || !so_far->files.has_report)
    return reply->Send(Sentence(404, "No map yet", "<p>There is no map of this job to see yet.</p>"));
  reply->Send(WithHeaders({.type = kHtml, .file = so_far->folder / "report.html"}, kFramedReportPolicy));
}

void Site::AnswerFile(const wire::JobInfo& job, const std::string& what, const Reply& reply) {
  const bool picture = what == "/picture", report = what == "/report";
  const std::string files = "/files/";
  if (!picture && !report && !what.starts_with(files)) return reply->Send(NotHere());
  const std::string file = what.starts_with(files) ? what.substr(files.size()) : "";
  source_->FetchResults(ResultsNow(job), [picture, report, file, reply](const FetchedResults& fetched) {
    if (picture) {
      if (!fetched.trouble.empty() || fetched.picture.empty())
        return reply->Send(
            SentenceAsPicture(fetched.trouble.empty() ? "This result has no picture." : fetched.trouble));
      return reply->Send(WithHeaders({.type = "image/png", .file = fetched.folder / fetched.picture}));
    }
    if (!fetched.trouble.empty())
      return reply->Send(Sentence(404, "No result", "<p>" + Text(fetched.trouble) + "</p>"));
    if (report && fetched.files.has_report)
      return reply->Send(WithHeaders({.type = kHtml, .file = fetched.folder / "report.html"}, kReportPolicy));
    for (const std::string& stage : fetched.files.stages) {
      if (file != stage + ".h5") continue;
      HttpAnswer answer{.type = "application/x-hdf5", .file = fetched.folder / file};
      answer.headers.emplace_back("Content-Disposition",
                                  "attachment; filename=\"" + UrlPart(stage) + ".h5\"");
      return reply->Send(WithHeaders(std::move(answer)));
    }
    reply->Send(report ? Sentence(404, "No report", "<p>Results of this kind have no report.</p>")
                       : NotHere());
  });
}

void Site::AnswerPost(const HttpRequest& request, const Reply& reply) {
  if (request.path.starts_with("/new/")) return AnswerStart(request, reply);
  if (request.Header("x-cairn") != "page")
    return reply->Send(JsonAnswer(false, "This was not sent by a page of Cairn's."));
  if (request.path == "/logout") {
    entrance_.Forget(request);
    return reply->Send(JsonAnswer(true, "Signed out."));
  }
  const std::string jobs = "/jobs/";
  const std::size_t slash = request.path.rfind('/');
  const wire::JobInfo* job = nullptr;
  const FactsPtr facts = source_->Latest();
  std::string id, action;
  if (request.path.starts_with(jobs) && slash > jobs.size()) {
    id = request.path.substr(jobs.size(), slash - jobs.size());
    action = request.path.substr(slash + 1);
    job = facts->Find(id);
  }
  if (job == nullptr) return reply->Send(JsonAnswer(false, "There is no such job any more."));
  if (options_.read_only)
    return reply->Send(JsonAnswer(false, "This page shows jobs, and commands none (--read-only)."));
  const std::vector<std::string> all = {"pause", "resume", "cancel", "retry", "delete", "priority"};
  if (std::ranges::find(all, action) == all.end())
    return reply->Send(JsonAnswer(false, "There is no such command."));
  int priority = 0;
  const std::string wanted = FormValues(request.body)["priority"];
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), priority);
  if (action == "priority" && (error != std::errc() || end != wanted.data() + wanted.size()))
    return reply->Send(JsonAnswer(false, "A priority is a whole number."));
  source_->Command(id, action, priority, [reply](const CommandOutcome& outcome) {
    reply->Send(JsonAnswer(outcome.ok, outcome.text));
  });
}

// One who opens masses of pages leaves room for others, and whoever signs in again and again does, too.
void Site::AnswerEvents(const HttpRequest& request, const Reply& reply) {
  std::weak_ptr<int>& of_session = seats_[entrance_.FormToken(request)];
  std::shared_ptr<int> seat = of_session.lock();
  if (!seat) of_session = seat = std::make_shared<int>();
  const long own = seat.use_count() - 1;
  long all = -1;  // this request is no stream yet
  for (const auto& [session, held] : seats_) all += held.use_count();
  if (own >= kMostOfASession || (own > 0 && all + kKept >= long{kMostStreams}))
    return reply->Send(Sentence(503, "Not live", "<p>Many pages are open.</p>"));
  NoteListener(request);
  reply->Send(WithHeaders({.type = "text/event-stream",
                           .stream = std::make_shared<PartsStream>(
                               shared_from_this(), ViewOf(request.Query("for"), request), std::move(seat))}));
  std::erase_if(seats_, [](const auto& of) { return of.second.expired(); });
}

bool Site::MayCommand(const wire::JobInfo* job) const {
  return job != nullptr && !options_.read_only && !job->foreign();
}

HttpAnswer Site::PageOf(const View& view) {
  const FactsPtr facts = source_->Latest();
  const std::shared_ptr<const Parts> parts = PartsFor(view);
  const std::string notice = parts->front().second;
  std::string main = "<div id=\"parts\">\n" + PartsHtml(*parts) + "</div>\n";
  if (view.kind == View::Kind::kWorkers) main = "<h1>Workers</h1>\n" + main;
  if (view.kind == View::Kind::kJobs) main = "<h1>Jobs</h1>\n" + FilterForm(view) + main;
  const bool gone = view.kind == View::Kind::kJob && facts->known && facts->Find(view.job) == nullptr;
  return WithHeaders({.code = gone ? 404u : 200u,
                      .body = Page(TitleOf(view, *facts), main, notice, EventsOf(view), options_.foot),
                      .type = kHtml});
}

std::shared_ptr<const Parts> Site::PartsFor(const View& view) {
  const FactsPtr facts = source_->Latest();
  const bool of_job = view.kind == View::Kind::kJob;
  const wire::JobInfo* job = of_job ? facts->Find(view.job) : nullptr;
  const HistoryPtr history = job != nullptr ? source_->HistoryOf(*job) : nullptr;
  const auto so_far = job != nullptr && !job->so_far().empty() ? source_->SoFar(*job) : nullptr;
  const std::string version = so_far ? so_far->folder.filename().string() : "";
  const auto fetched = job != nullptr ? source_->Fetched(ResultsNow(*job)) : nullptr;
  const std::string key = view.Address();
  const std::lock_guard lock(mutex_);
  if (const auto made = made_.find(key);
      made != made_.end() && made->second.of == facts && made->second.history == history &&
      made->second.fetched == (fetched != nullptr) && made->second.so_far == version)
    return made->second.parts;
  if (made_.size() >= kMostMade) made_.clear();
  std::vector<std::pair<std::string, std::string>> brought;
  if (of_job && options_.desk != nullptr)
    for (const BroughtFile& file : options_.desk->Files())
      if (file.Kind() == "log" || file.Kind() == "samples")
        brought.emplace_back(std::to_string(file.number), file.name);
  auto parts = std::make_shared<const Parts>(PartsOf(view, {.facts = *facts,
                                                            .history = history,
                                                            .results = fetched ? &fetched->files : nullptr,
                                                            .so_far = version,
                                                            .may_command = MayCommand(job),
                                                            .may_start = WhyNoStart().empty(),
                                                            .brought = std::move(brought)}));
  made_[key] = {facts, history, fetched != nullptr, version, parts};
  return parts;
}

}  // namespace cairn::page
