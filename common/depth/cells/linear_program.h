#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace mortise {

/// Linear programs in at most five variables over many rows: maximize objective · y subject to
/// g · y <= h for every row and lo <= y <= hi. Method of Seidel in the order of the rows: expected
/// time linear in the rows, deterministic, without tolerance in what it returns as bound.
class LinearProgram {
 public:
  static constexpr int kMostVariables = 5;  ///< a point and its depth in either part
  using Vector = std::array<double, kMostVariables>;
  struct Row {
    Vector g{};
    double h = 0.0;
  };
  struct Optimum {
    Vector y{};
    std::array<int, kMostVariables>
        active{};  ///< rows that meet in y; ~(2k + side): a bound of y_k
  };

  LinearProgram(int variables, const Vector& lo, const Vector& hi, const Vector& objective);

  std::vector<Row> rows;

  /// False: no point fulfils all rows within 1e-9; those that are meant to be closed by a rounding
  /// must be given with that much room.
  bool maximize(Optimum& optimum);
  /// The optimum of all rows and `row`, given that of all rows alone, which `row` cuts off.
  bool maximize_with(const Row& row, Optimum& optimum);
  bool cuts_off(const Row& row, const Optimum& optimum) const;
  /// A row by its number, or a bound, see Optimum::active.
  Row row_of(int id) const;

  /// Upper bound of the objective over all points that fulfil the rows: the sum of the active rows
  /// weighted by their dual multipliers, and what these leave over times the bounds. It is true
  /// whatever the active rows are.
  double upper_bound(const Optimum& optimum) const;
  /// The dual multiplier of each active row, >= 0.
  Vector multipliers(const Optimum& optimum) const;

 private:
  struct Reduced {
    Vector g{};
    double h = 0.0;
    int id = 0;
  };
  struct Level {
    std::vector<Reduced> rows;
    Vector lo{}, hi{}, objective{};
    std::array<int, kMostVariables> variable{};  // which of the original ones
  };
  Level& set_up();
  bool solve(int variables, Optimum& found);
  bool solve_line(Optimum& found);
  bool solve_on(int variables, const Reduced& row, std::size_t rows_before, Optimum& found);
  static bool push(Level& level, int variables, const Reduced& row);

  int variables_;
  Vector lo_, hi_, objective_;
  std::array<Level, kMostVariables + 1> level_;
};

}  // namespace mortise
