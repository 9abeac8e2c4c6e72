#include "tests/stress/record.h"

#include <fenv.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

namespace mortise::stress {
namespace {

constexpr int kTrapped = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;
constexpr int kFaultsTold = 5;  // of one sweep; the rest is counted

bool traps_wanted() {
  static const bool wanted = [] {
    const char* set = std::getenv("MORTISE_TRAP");
    return set != nullptr && std::string(set) == "1";
  }();
  return wanted;
}

class Table : public ::testing::Environment {
 public:
  static Table& instance() {
    static auto* table =
        static_cast<Table*>(::testing::AddGlobalTestEnvironment(new Table));  // gtest owns it
    return *table;
  }
  void add(std::string row, int queries) {
    rows_.push_back(std::move(row));
    queries_ += queries;
  }
  void TearDown() override {
    if (rows_.empty()) return;
    std::printf(
        "\n| sweep | asked | contact | free | at start | undecided | tired | missed | late | false "
        "| worst "
        "late mm | worst early / accuracy | worst error mm | bound mm |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& row : rows_) std::printf("%s\n", row.c_str());
    std::printf("%d queries judged by the oracles\n", queries_);
  }

 private:
  std::vector<std::string> rows_;
  int queries_ = 0;
};

// Must be known to gtest before main runs the tests.
[[maybe_unused]] const Table& g_table = Table::instance();

}  // namespace

FloatGuard::FloatGuard(std::string label) : label_(std::move(label)) {
  feclearexcept(FE_ALL_EXCEPT);
#ifdef __GLIBC__
  if (traps_wanted()) before_ = feenableexcept(kTrapped);
#endif
}

FloatGuard::~FloatGuard() {
#ifdef __GLIBC__
  if (traps_wanted()) {
    fedisableexcept(kTrapped);
    feenableexcept(before_);
  }
#endif
  const int raised = fetestexcept(kTrapped);
  if (raised == 0) return;
  // The first few of each test are told.
  static const ::testing::TestInfo* test = nullptr;
  static int told = 0;
  if (test != ::testing::UnitTest::GetInstance()->current_test_info()) told = 0;
  test = ::testing::UnitTest::GetInstance()->current_test_info();
  if (told++ < kFaultsTold)
    ADD_FAILURE() << (raised & FE_INVALID ? "invalid operation " : "")
                  << (raised & FE_DIVBYZERO ? "division by zero " : "")
                  << (raised & FE_OVERFLOW ? "overflow" : "") << ": " << label_;
}

Sweep::Sweep(std::string name) : name_(std::move(name)) {}

Sweep::~Sweep() {
  char row[400];
  const auto number = [](double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", x);
    return std::string(text);
  };
  const bool judged = queries_ > 0;
  std::snprintf(row, sizeof row,
                "| %s | %d | %d | %d | %d | %d | %d | %d | %d | %d | %s | %s | %s | %s |",
                name_.c_str(), queries_, contacts_, free_, at_start_, undecided_, tired_, missed_,
                late_, invented_, number(late_mm_).c_str(), judged ? number(early_).c_str() : "",
                bound_mm_ > 0.0 ? number(error_mm_).c_str() : number(witness_).c_str(),
                bound_mm_ > 0.0 ? number(bound_mm_).c_str() : "");
  Table::instance().add(row, queries_);
  EXPECT_EQ(missed_, 0) << name_;
  EXPECT_EQ(late_, 0) << name_ << ", worst " << late_mm_ << " mm";
  EXPECT_EQ(invented_, 0) << name_;
  EXPECT_EQ(wrong_, 0) << name_;
}

void Sweep::fault(const char* what, double by_mm, const std::string& label) {
  if (faults_told_++ < kFaultsTold)
    ADD_FAILURE() << name_ << ": " << what << " by " << by_mm << " mm: " << label;
}

FirstContact Sweep::ask(const Case& c, const std::string& label, int looks) {
  thread_local CcdScratch scratch;
  c.a->bvh(), c.b->bvh();
  FirstContact answer;
  {
    const FloatGuard guard(name_ + ": " + label);
    answer = first_contact(query_of(c), scratch);
  }
  add(c, answer, label, looks);
  return answer;
}

Judgement Sweep::add(const Case& c, const FirstContact& answer, const std::string& label,
                     int looks) {
  const Judgement j = judge(c, answer, looks);
  const double accuracy = Oracle(c).accuracy_mm();
  ++queries_;
  contacts_ += j.contact;
  free_ += j.free;
  at_start_ += j.at_start;
  undecided_ += j.undecided;
  tired_ += j.tired;
  missed_ += j.missed;
  late_ += j.late;
  invented_ += j.invented;
  wrong_ += j.wrong;
  late_mm_ = std::max(late_mm_, j.late_mm);
  early_ = std::max(early_, j.early_mm / accuracy);
  witness_ = std::max(witness_, j.witness_mm);
  if (j.missed) fault("missed", 0.0, label);
  if (j.late) fault("late", j.late_mm, label);
  if (j.invented) fault("false", j.early_mm, label);
  if (j.wrong) fault("contradicts the contract", j.witness_mm, label);
  return j;
}

void Sweep::measured(double error_mm, double bound_mm, const std::string& label) {
  error_mm_ = std::max(error_mm_, error_mm);
  bound_mm_ = std::max(bound_mm_, bound_mm);
  if (!(error_mm <= bound_mm)) {
    ++wrong_;
    fault("beyond its bound", error_mm, label);
  }
}

}  // namespace mortise::stress
