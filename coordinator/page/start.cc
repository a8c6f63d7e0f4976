#include "coordinator/page/start.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "coordinator/page/answers.h"
#include "coordinator/page/entrance.h"
#include "coordinator/page/html.h"
#include "coordinator/page/start_view.h"
#include "coordinator/page/views.h"

namespace cairn::page {
namespace {

using coordinator::HttpAnswer;
using coordinator::HttpRequest;
using Json = nlohmann::json;

bool ToNumber(const std::string& text, std::uint64_t* number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  return error == std::errc() && end == text.data() + text.size();
}

std::string Sentenced(const std::string& said) {
  return "<div class=\"advice bad\"><p><b>" + Text(said) + "</b></p></div>\n";
}

std::string NameIn(const Json& of_pipeline) {
  return of_pipeline.is_object() ? of_pipeline.value("name", "") : "";
}

const Json* PipelineCalled(const Json& pipelines, const std::string& name) {
  for (const Json& pipeline : pipelines)
    if (NameIn(pipeline) == name) return &pipeline;
  return nullptr;
}

// Options and inputs that are empty are left out, as are those that the pipeline has not: nothing that a form
// says is a word of a command but in its own place, and a name with a '=' would be more than a name.
JobOrder OrderOf(std::map<std::string, std::string> values, const BroughtFile& file, const Json& pipeline) {
  JobOrder order{.pipeline = NameIn(pipeline), .name = values["name"], .file = file.number};
  order.seed = values["seed"];
  order.priority = values["priority"] == "0" ? "" : values["priority"];
  order.units_are_right = !values["units_are_right"].empty();
  for (const Json& option : ListIn(pipeline, "options"))
    if (const std::string& value = values["set." + NameIn(option)]; !value.empty())
      order.settings[NameIn(option)] = value;
  for (const Json& input : ListIn(pipeline, "inputs"))
    if (std::uint64_t number = 0; ToNumber(values["input." + NameIn(input)], &number))
      order.inputs[NameIn(input)] = number;
  return order;
}

}  // namespace

struct StartPages::Place {
  BroughtFile file;
  std::string what;  // "landmark_map", "remove"; empty: the file
};

bool StartPages::Find(const std::string& path, Place* place) {
  const std::string begin = "/new/";
  if (!path.starts_with(begin)) return false;
  const std::size_t slash = std::min(path.find('/', begin.size()), path.size());
  std::uint64_t number = 0;
  if (!ToNumber(path.substr(begin.size(), slash - begin.size()), &number)) return false;
  const std::vector<BroughtFile> files = desk_->Files();
  const auto file = std::ranges::find(files, number, &BroughtFile::number);
  if (file == files.end()) return false;
  *place = {*file, slash == path.size() ? "" : path.substr(slash + 1)};
  return true;
}

HttpAnswer StartPages::PageOf(unsigned code, const std::string& title, const std::string& main) const {
  return WithHeaders({.code = code, .body = Page(title, main, "", "", foot_), .type = kHtml});
}

HttpAnswer StartPages::FilesPage(unsigned code, const std::string& token, const std::string& trouble,
                                 const std::string& job) {
  return PageOf(code, "Start a job", FilesHtml({desk_->Files(), desk_->most_bytes(), token, job}, trouble));
}

void StartPages::Get(const HttpRequest& request, const std::string& token, const Reply& reply) {
  const std::string& path = request.path;
  if (path == "/new") return reply->Send(FilesPage(200, token, "", request.Query("job")));
  Place place;
  if (!Find(path, &place))
    return reply->Send(FilesPage(404, token, "That file is not here any more: bring it again."));
  desk_->Pipelines(
      [self = shared_from_this(), place, token, reply](const Json& pipelines, const std::string& trouble) {
        if (!trouble.empty()) return reply->Send(self->FilesPage(500, token, trouble));
        const StartContext context{self->desk_->Files(), self->desk_->most_bytes(), token};
        if (place.what.empty())
          return reply->Send(self->PageOf(200, place.file.name, FileHtml(context, place.file, pipelines)));
        const Json* pipeline = PipelineCalled(pipelines, place.what);
        if (pipeline == nullptr) return reply->Send(NotHere());
        reply->Send(self->PageOf(200, place.what,
                                 OrderHtml(context, place.file, *pipeline, {.pipeline = place.what}, "")));
      });
}

std::shared_ptr<coordinator::HttpUpload> StartPages::Begin(const HttpRequest& request) {
  std::uint64_t announced = 0;
  if (!ToNumber(request.Header("content-length"), &announced)) announced = 0;
  return desk_->Begin(announced, request.Query("token"));  // which is right, and each session has its own
}

void StartPages::Post(const HttpRequest& request, const std::string& token, const Reply& reply) {
  const auto self = shared_from_this();
  if (request.path == "/new/upload") {
    const auto upload = std::dynamic_pointer_cast<Upload>(request.upload);
    if (!upload) return reply->Send(FilesPage(400, token, "The file did not come whole: bring it again."));
    return desk_->Keep(upload, [self, token, reply](std::uint64_t number, const std::string& trouble) {
      reply->Send(number == 0 ? self->FilesPage(400, token, trouble)
                              : GoTo("/new/" + std::to_string(number)));
    });
  }
  if (request.path == "/new/from-job") {
    std::map<std::string, std::string> values = FormValues(request.body);
    return desk_->FromJob(values["job"], values["what"] == "inputs",
                          [self, token, reply](std::uint64_t number, const std::string& trouble) {
                            reply->Send(number == 0 ? self->FilesPage(400, token, trouble)
                                                    : GoTo("/new/" + std::to_string(number)));
                          });
  }
  Place place;
  if (!Find(request.path, &place))
    return reply->Send(FilesPage(404, token, "That file is not here any more: bring it again."));
  if (place.what == "remove") {
    desk_->Remove(place.file.number);
    return reply->Send(GoTo("/new"));
  }
  AnswerOrder(place, FormValues(request.body), token, reply);
}

void StartPages::AnswerOrder(const Place& place, std::map<std::string, std::string> values,
                             const std::string& token, const Reply& reply) {
  desk_->Pipelines([self = shared_from_this(), place, values = std::move(values), token, reply](
                       const Json& pipelines, const std::string& trouble) {
    const Json* pipeline = PipelineCalled(pipelines, place.what);
    if (pipeline == nullptr)
      return reply->Send(trouble.empty() ? NotHere() : self->FilesPage(500, token, trouble));
    const JobOrder order = OrderOf(values, place.file, *pipeline);
    const auto again = [self, place, order, token, reply, form = *pipeline](unsigned code,
                                                                            const std::string& said) {
      const StartContext context{self->desk_->Files(), self->desk_->most_bytes(), token};
      reply->Send(self->PageOf(code, place.what, OrderHtml(context, place.file, form, order, said)));
    };
    const auto failed = [again](const Helper::Outcome& said) {
      again(said.bad_input ? 400 : 502, Sentenced(said.trouble));
    };
    if (const auto action = values.find("do"); action != values.end() && action->second == "submit")
      return self->desk_->Submit(order, [reply, failed](const Helper::Outcome& said) {
        const Json job = Json::parse(said.printed, nullptr, false);
        const std::string id = job.is_object() ? job.value("id", "") : "";
        if (!said.trouble.empty() || id.empty()) return failed(said);
        reply->Send(GoTo("/jobs/" + UrlPart(id)));
      });
    self->desk_->Plan(order, [again, failed](const Helper::Outcome& said) {
      const Json plan = Json::parse(said.printed, nullptr, false);
      if (!said.trouble.empty() || !plan.is_object()) return failed(said);
      again(200, PlanHtml(plan));
    });
  });
}

}  // namespace cairn::page
