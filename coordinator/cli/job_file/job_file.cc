#include "coordinator/cli/job_file/job_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "coordinator/cli/common/suggest.h"
#include "coordinator/cli/job_file/yaml_reader.h"
#include "coordinator/core/job.h"
#include "schema/error.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

class JobReader {
 public:
  JobReader(const std::string& path, const Catalog& catalog)
      : path_(path), yaml_(path), catalog_(catalog), folder_(fs::path(path).parent_path()) {}

  ParsedJob Read() {
    const YAML::Node root = yaml_.Load(path_);
    const std::vector<YamlEntry> entries = yaml_.Map(root, "the job", 1);
    parsed_.job.set_name(fs::path(path_).stem().string());
    const YamlEntry* inputs = nullptr;
    const YamlEntry* stages = nullptr;
    for (const YamlEntry& entry : entries) {
      if (entry.key == "name")
        parsed_.job.set_name(yaml_.Name(entry));
      else if (entry.key == "seed")
        parsed_.job.set_seed(yaml_.Unsigned(entry));
      else if (entry.key == "priority")
        parsed_.job.set_priority(Priority(entry));
      else if (entry.key == "task_time_s")
        parsed_.job.set_task_time_s(TaskTime(entry));
      else if (entry.key == "task_memory_mb")
        parsed_.job.set_task_memory_mb(TaskMemory(entry));
      else if (entry.key == "inputs")
        inputs = &entry;
      else if (entry.key == "stages")
        stages = &entry;
      else
        ThrowUnknownKey(entry,
                        {"name", "seed", "priority", "task_time_s", "task_memory_mb", "inputs", "stages"});
    }
    yaml_.CheckName(parsed_.job.name(), 1, "name (the file's, where none is given)");
    if (inputs == nullptr)
      yaml_.Refuse(YamlReader::Line(root), "'inputs' is missing: `inputs: {log: FILE.h5}`");
    if (stages == nullptr)
      yaml_.Refuse(YamlReader::Line(root), "'stages' is missing: a list of pipelines to run");
    ReadInputs(*inputs);
    ReadStages(*stages);
    RequireAllUsed();
    return std::move(parsed_);
  }

 private:
  [[noreturn]] void ThrowUnknownKey(const YamlEntry& entry, const std::vector<std::string>& known) const {
    yaml_.Refuse(entry.key_line, "unknown key '" + entry.key + "'" + Suggest(entry.key, known));
  }

  int Priority(const YamlEntry& entry) const {
    const std::string text =
        entry.value.IsScalar() && !YamlReader::IsQuoted(entry.value) ? entry.value.Scalar() : "";
    const char* const end = text.data() + text.size();
    int priority = 0;
    const auto [rest, error] = std::from_chars(text.data(), end, priority);
    if (error != std::errc{} || rest != end || priority < coordinator::kLowestPriority ||
        priority > coordinator::kHighestPriority)
      yaml_.Refuse(entry.line, "priority: a whole number from -10 to 10");
    return priority;
  }

  double TaskTime(const YamlEntry& entry) const {
    const std::string text =
        entry.value.IsScalar() && !YamlReader::IsQuoted(entry.value) ? entry.value.Scalar() : "";
    const char* const end = text.data() + text.size();
    double seconds = 0;
    const auto [rest, error] = std::from_chars(text.data(), end, seconds);
    if (error != std::errc{} || rest != end || !std::isfinite(seconds) || seconds <= 0)
      yaml_.Refuse(entry.line, "task_time_s: a time in seconds, above 0");
    return seconds;
  }

  std::uint64_t TaskMemory(const YamlEntry& entry) const {
    const std::string text =
        entry.value.IsScalar() && !YamlReader::IsQuoted(entry.value) ? entry.value.Scalar() : "";
    const char* const end = text.data() + text.size();
    std::uint64_t mb = 0;
    const auto [rest, error] = std::from_chars(text.data(), end, mb);
    if (error != std::errc{} || rest != end || mb < 1 || mb > coordinator::kMostTaskMemory_mb)
      yaml_.Refuse(entry.line, "task_memory_mb: a whole number of megabytes, above 0");
    return mb;
  }

  void ReadInputs(const YamlEntry& inputs) {
    for (const YamlEntry& entry : yaml_.Map(inputs.value, "inputs", inputs.line)) {
      yaml_.CheckName(entry.key, entry.key_line, "input");
      const std::string written = yaml_.Text(entry);
      const std::string file = (folder_ / written).string();
      if (const std::string why = WhyNoFile(file); !why.empty())
        yaml_.Refuse(entry.line, "input '" + entry.key + "': " + why);
      (*parsed_.job.mutable_inputs())[entry.key] = written;
      parsed_.inputs[entry.key] = {file,
                                   path_ + ":" + std::to_string(entry.line) + ": input '" + entry.key + "'"};
      input_lines_[entry.key] = entry.key_line;
    }
    if (parsed_.inputs.empty()) yaml_.Refuse(inputs.key_line, "'inputs' is empty: `inputs: {log: FILE.h5}`");
  }

  void ReadStages(const YamlEntry& stages) {
    const std::vector<YAML::Node> nodes = yaml_.Sequence(stages);
    if (nodes.empty()) yaml_.Refuse(stages.key_line, "'stages' is empty: a job has at least one");
    for (const YAML::Node& node : nodes) NameStage(node);
    for (const YAML::Node& node : nodes) ReadStage(node);
  }

  // First all names, so that a stage that names a later one hears so.
  void NameStage(const YAML::Node& node) {
    for (const YamlEntry& entry : yaml_.Map(node, "a stage", YamlReader::Line(node))) {
      if (entry.key != "name") continue;
      const std::string name = yaml_.Name(entry);
      const auto [it, fresh] = stage_lines_.emplace(name, entry.line);
      if (!fresh)
        yaml_.Refuse(entry.line,
                     "stage '" + name + "' was named already, at line " + std::to_string(it->second));
      if (parsed_.inputs.contains(name))
        yaml_.Refuse(entry.line, "stage '" + name + "' has the name of an input");
      // Its pages go into a folder of its name, beside them and beside the results of all stages.
      if (coordinator::IsFileOfARun(name))
        yaml_.Refuse(entry.line, "stage '" + name + "' has the name of a file that a run writes");
      return;
    }
    CheckStageKeys(yaml_.Map(node, "a stage", YamlReader::Line(node)));
    yaml_.Refuse(YamlReader::Line(node), "a stage without 'name'");
  }

  // Of a stage that lacks what each has: a mistyped key is why.
  void CheckStageKeys(const std::vector<YamlEntry>& entries) const {
    std::vector<std::string> known = {"name", "pipeline", "options"};
    for (const PipelineSpec& pipeline : catalog_.pipelines())
      for (const std::string& input : pipeline.InputNames())
        if (std::ranges::find(known, input) == known.end()) known.push_back(input);
    for (const YamlEntry& entry : entries)
      if (std::ranges::find(known, entry.key) == known.end()) ThrowUnknownKey(entry, known);
  }

  void ReadStage(const YAML::Node& node) {
    const std::vector<YamlEntry> entries = yaml_.Map(node, "a stage", YamlReader::Line(node));
    const PipelineSpec& pipeline = PipelineOf(node, entries);
    proto::Stage stage;
    stage.set_pipeline(pipeline.name);
    for (const YamlEntry& entry : entries) {
      if (entry.key == "pipeline") continue;
      if (entry.key == "name")
        stage.set_name(yaml_.Name(entry));
      else if (entry.key == "options")
        ReadOptions(entry, pipeline, stage);
      else
        ReadStageInput(entry, pipeline, stage);
    }
    for (const InputSpec& input : pipeline.inputs) {
      if (input.optional || stage.inputs().contains(input.name)) continue;
      yaml_.Refuse(YamlReader::Line(node), "stage '" + stage.name() + "': " + pipeline.name + " needs `" +
                                               input.name + ": NAME` of an input or an earlier stage");
    }
    done_stages_.push_back(stage.name());
    *parsed_.job.add_stages() = std::move(stage);
  }

  const PipelineSpec& PipelineOf(const YAML::Node& node, const std::vector<YamlEntry>& entries) const {
    for (const YamlEntry& entry : entries) {
      if (entry.key != "pipeline") continue;
      const std::string name = yaml_.Text(entry);
      try {
        return catalog_.At(name);
      } catch (const InputError& error) {
        yaml_.Refuse(entry.line, error.what());
      }
    }
    CheckStageKeys(entries);
    yaml_.Refuse(YamlReader::Line(node), "a stage without 'pipeline'");
  }

  void ReadStageInput(const YamlEntry& entry, const PipelineSpec& pipeline, proto::Stage& stage) {
    if (pipeline.FindInput(entry.key) == nullptr) {
      std::vector<std::string> known = {"name", "pipeline", "options"};
      for (const std::string& input : pipeline.InputNames()) known.push_back(input);
      ThrowUnknownKey(entry, known);
    }
    const std::string source = yaml_.Text(entry);
    if (parsed_.inputs.contains(source))
      input_lines_.erase(source);
    else
      CheckEarlier(entry, source);
    (*stage.mutable_inputs())[entry.key] = source;
  }

  void CheckEarlier(const YamlEntry& entry, const std::string& source) const {
    if (std::ranges::find(done_stages_, source) != done_stages_.end()) return;
    const auto later = stage_lines_.find(source);
    if (later != stage_lines_.end()) {
      yaml_.Refuse(entry.line, entry.key + ": stage '" + source + "' is no earlier one (line " +
                                   std::to_string(later->second) + "); stages run in order");
    }
    std::vector<std::string> known = done_stages_;
    for (const auto& [name, input] : parsed_.inputs) known.push_back(name);
    yaml_.Refuse(entry.line, entry.key + ": there is no input or earlier stage '" + source + "'" +
                                 Suggest(source, known));
  }

  void ReadOptions(const YamlEntry& options, const PipelineSpec& pipeline, proto::Stage& stage) const {
    for (const YamlEntry& entry : yaml_.Map(options.value, "options", options.line)) {
      const OptionSpec* spec = pipeline.FindOption(entry.key);
      if (spec == nullptr) {
        yaml_.Refuse(entry.key_line, "unknown option '" + entry.key + "' of " + pipeline.name +
                                         Suggest(entry.key, pipeline.OptionNames()));
      }
      if (stage.options().contains(spec->name))
        yaml_.Refuse(entry.key_line, "option '" + spec->name + "' was given already");
      if (!entry.value.IsScalar()) yaml_.Refuse(entry.line, entry.key + ": allowed: " + spec->Allowed());
      const Quoting quoting = YamlReader::IsQuoted(entry.value) ? Quoting::kQuoted : Quoting::kPlain;
      try {
        (*stage.mutable_options())[spec->name] = ParseOption(*spec, entry.value.Scalar(), quoting);
      } catch (const InputError& error) {
        yaml_.Refuse(entry.line, entry.key + ": " + error.what());
      }
    }
  }

  void RequireAllUsed() const {
    for (const auto& [name, line] : input_lines_)
      yaml_.Refuse(line, "input '" + name + "' is used by no stage");
  }

  std::string path_;
  YamlReader yaml_;
  const Catalog& catalog_;
  fs::path folder_;
  ParsedJob parsed_;
  std::map<std::string, int> input_lines_;  // of inputs that no stage has used yet
  std::map<std::string, int> stage_lines_;
  std::vector<std::string> done_stages_;
};

}  // namespace

std::string WhyNoFile(const std::string& path) {
  std::error_code ignored;  // a name may be too long to be one
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_regular_file(status)) return "";
  return fs::exists(status) ? "'" + path + "' is no file" + (fs::is_directory(status) ? ", but a folder" : "")
                            : "there is no file '" + path + "'";
}

ParsedJob ReadJobFile(const std::string& path, const Catalog& catalog) {
  return JobReader(path, catalog).Read();
}

}  // namespace cairn::cli
