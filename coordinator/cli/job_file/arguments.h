// What `cairn run` and `cairn submit` take to say what is to be done: a job file, or a pipeline and
// the file that it reads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "coordinator/cli/job_file/catalog.h"
#include "coordinator/cli/job_file/job_file.h"
#include "schema/command_line/command.h"

namespace cairn::cli {

struct JobArguments {
  std::string what;                   // a job file (.yaml, .yml), or a pipeline
  std::string file;                   // of the pipeline's main input
  std::vector<std::string> settings;  // key=value
  std::uint64_t seed = 0;
  std::vector<std::string> inputs;  // name=FILE, beside the main one
  bool units_are_right = false;     // take a log of what no robot does
  std::string name = {};            // of the job, where a pipeline is named; empty: as the pipeline
};

// The input that a file is for whose name stands alone: the first one of the pipeline's list.
const std::string& MainInput(const PipelineSpec& pipeline);

bool IsJobFile(const std::string& what);

void AddJobArguments(Command command, JobArguments& arguments);

// Reads the job file; or makes a job of one stage, both with the pipeline's name.
// Throws InputError that names the argument, or file and line, and what is allowed.
ParsedJob ResolveJob(const JobArguments& arguments, const Catalog& catalog);

}  // namespace cairn::cli
