// The programs that are installed beside this one.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cairn::cli {

// The path of cairn-worker, in the folder of the running `cairn`.
// Throws WorldError where there is none.
std::string WorkerProgram();

// The same of cairn-images, of cairn-tags, of cairn-page, and of cairn itself.
std::string ImagesProgram();
std::string TagsProgram();
std::string PageProgramPath();
std::string CairnProgram();

// What `program arguments…` prints on stdout; `input`: what it reads on stdin.
// Throws WorldError where it cannot be run or fails.
std::string OutputOf(const std::string& program, const std::vector<std::string>& arguments,
                     const std::optional<std::string>& input = std::nullopt);

}  // namespace cairn::cli
