#include "tests/layering/equations.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace cairn::layering {
namespace {

namespace fs = std::filesystem;

TEST(Equations, OfEachReadmeStandInTheSourcesAndTheReverse) {
  const EquationCheck check = CheckEquations(CAIRN_SOURCE_DIR);
  std::string text;
  for (const Mismatch& mismatch : check.mismatches) text += ToText(mismatch) + "\n";
  EXPECT_EQ(text, "");
  EXPECT_GT(check.rows, 80) << "the READMEs are not where this test looks, or their tables are not read";
  EXPECT_GT(check.comments, 80)
      << "the sources are not where this test looks, or their comments are not read";
}

std::vector<std::string> Whats(const std::string& text) {
  std::vector<std::string> whats;
  for (const Reference& reference : ReferencesIn(text))
    whats.push_back(reference.paper + " " + reference.what);
  return whats;
}

using Texts = std::vector<std::string>;

TEST(ReferencesIn, ReadsListsRangesAndSteps) {
  EXPECT_EQ(Whats("// [TBF98] eq. 16: so"), Texts{"TBF98 eq. 16"});
  EXPECT_EQ(Whats("([Thr98] eqs 4, 6 and 8 to 10)."),
            (Texts{"Thr98 eq. 4", "Thr98 eq. 6", "Thr98 eq. 8", "Thr98 eq. 9", "Thr98 eq. 10"}));
  EXPECT_EQ(Whats("[DM98] figure 1, steps 4 and 5."),
            (Texts{"DM98 figure 1, step 4", "DM98 figure 1, step 5"}));
  EXPECT_EQ(Whats("[Thr98] section 5.1.6, figure 6"), (Texts{"Thr98 section 5.1.6", "Thr98 figure 6"}));
  EXPECT_EQ(Whats("[DM98] eq. 1, [TBF98] footnote 1"), (Texts{"DM98 eq. 1", "TBF98 footnote 1"}));
}

TEST(ReferencesIn, AreOfThePaperRightBeforeThem) {
  EXPECT_EQ(Whats("eq. 16, Eqs 3 and 4"), Texts{});
  EXPECT_EQ(Whats("[TBF98] has it in eq. 16"), Texts{});
  EXPECT_EQ(Whats("[T] eq. 16, prefigure 3"), Texts{});
}

// A tree of one pipeline, gone at the end of the test.
class PlantedPipeline {
 public:
  PlantedPipeline() : root_(fs::path(testing::TempDir()) / ("cairn_equations_" + std::to_string(getpid()))) {
    Write("CITATION.cff", "references:\n  - title: A\n    abbreviation: TBF98\n");
    Write("pipelines/em/README.md", kHead + "| eq. 16: alpha | `Forward` | `EStep.Sums…` | |\n");
    Write("pipelines/em/em.cc", "void Forward() {\n  // [TBF98] eq. 16\n  a = b;\n}\n");
    Write("pipelines/em/em_test.cc", "TEST(EStep, SumsToOne) {}\n");
  }
  ~PlantedPipeline() { fs::remove_all(root_); }

  void Write(const std::string& file, const std::string& text) const {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text;
  }

  // "file:line" of what is found, by spaces.
  std::string Find() const {
    std::string found;
    for (const Mismatch& m : CheckEquations(root_).mismatches)
      found +=
          (found.empty() ? "" : " ") + fs::path(m.file).filename().string() + ":" + std::to_string(m.line);
    return found;
  }

  inline static const std::string kHead =
      "# em\n\n| [TBF98] | function | test | deviation |\n| --- | --- | --- | --- |\n";

 private:
  fs::path root_;
};

TEST(PlantedEquation, IsRightAsItStands) { EXPECT_EQ(PlantedPipeline().Find(), ""); }

TEST(PlantedEquation, WithoutAComment) {
  const PlantedPipeline tree;
  for (const char* source :
       {"void Forward();\n", "// [TBF98] eq. 16\n#include <a>\nForward\n", "Forward(a);  // [TBF98] eq. 16\n",
        "// By [TBF98] eq. 16.\nForward(a);\n", "// [TBF98] eq. 16\n\nForward(a);\n"}) {
    tree.Write("pipelines/em/em.cc", source);
    EXPECT_EQ(tree.Find(), "README.md:5") << source;
  }
}

TEST(PlantedEquation, IsNotADeclarationsNorATests) {
  const PlantedPipeline tree;
  tree.Write("pipelines/em/em.cc", "");
  tree.Write("pipelines/em/em.h", "// [TBF98] eq. 16\nvoid Forward();\n");
  EXPECT_EQ(tree.Find(), "README.md:5");
  tree.Write("pipelines/em/em.h", "// [TBF98] eq. 16\nstruct Forward {\n};\n");
  EXPECT_EQ(tree.Find(), "README.md:5");
  tree.Write("pipelines/em/em.h", "// [TBF98] eq. 16\ninline void Forward(int a,\n  int b) { c = a; }\n");
  EXPECT_EQ(tree.Find(), "");
  tree.Write("pipelines/em/em.h", "void Forward();\n");
  tree.Write("pipelines/em/em_test.cc", "// [TBF98] eq. 16\nTEST(EStep, SumsToOne) {}\n");
  EXPECT_EQ(tree.Find(), "README.md:5");
}

TEST(PlantedEquation, WithoutARow) {
  const PlantedPipeline tree;
  tree.Write("pipelines/em/more.cc", "// Beta: [TBF98] eqs 16 and 17.\n");
  EXPECT_EQ(tree.Find(), "more.cc:1");
  tree.Write("pipelines/em/more.cc", "");
  tree.Write("datasets/evaluate/more.cc", "// [TBF98] eq. 17\na = b;\n");
  EXPECT_EQ(tree.Find(), "more.cc:1");
  tree.Write("datasets/evaluate/more.cc", "// [TBF98] eq. 16, and eq. 40 of another's\na = b;\n");
  EXPECT_EQ(tree.Find(), "");
}

TEST(PlantedEquation, OfNoPaper) {
  const PlantedPipeline tree;
  for (const char* source :
       {"// eq. 16\na = b;\n", "// Eq. 16: so.\nvoid Forward();\n", "a = b;  // eqs 16 to 18\n"}) {
    tree.Write("pipelines/em/more.cc", source);
    EXPECT_EQ(tree.Find(), "more.cc:1") << source;
  }
  tree.Write("pipelines/em/more.cc", "// [TBF99] eq. 16\na = b;\n");
  EXPECT_EQ(tree.Find(), "more.cc:1 more.cc:1");  // no such paper, and no row
}

TEST(PlantedEquation, InATableThatIsNone) {
  const PlantedPipeline tree;
  tree.Write("pipelines/em/README.md",
             "# em\n\n| equation | function | test | deviation |\n| --- | --- | --- | --- |\n");
  EXPECT_EQ(tree.Find(), "README.md:1 em.cc:2");
  tree.Write("pipelines/em/README.md", "");
  EXPECT_EQ(tree.Find(), "README.md:1 em.cc:2");
}

TEST(PlantedEquation, WhoseRowNamesWhatIsNotThere) {
  const PlantedPipeline tree;
  const std::string readme = "pipelines/em/README.md";
  tree.Write(readme, PlantedPipeline::kHead + "| eq. 16 | `Backward` | `EStep.Sums…` | |\n");
  EXPECT_EQ(tree.Find(), "README.md:5");
  tree.Write(readme, PlantedPipeline::kHead + "| eq. 16 | `em::Forward` | `EStep.SumsToTwo` | |\n");
  EXPECT_EQ(tree.Find(), "README.md:5");
  tree.Write(readme, PlantedPipeline::kHead +
                         "| eq. 16 | `Forward` | `EStep.*`, `….Any` | |\n| prediction | | | |\n");
  EXPECT_EQ(tree.Find(), "README.md:6");
  tree.Write(readme,
             PlantedPipeline::kHead + "| eq. 16 | `Forward` | | |\n| not in the paper: waves | | | |\n");
  EXPECT_EQ(tree.Find(), "");
}

}  // namespace
}  // namespace cairn::layering
