#pragma once
/// \file Recorded formulas, differentiated exactly and run as straight-line programs over numbers or packs.

#include <core/eigen_scalar.hpp>
#include <core/pack.hpp>
#include <core/types.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <span>
#include <tuple>
#include <vector>

namespace supple {

enum class Operation : std::uint8_t {
  Input,
  Constant,
  Add,
  Subtract,
  Multiply,
  Divide,
  Negate,
  MultiplyAdd,
  MultiplySubtract,
  NegateMultiplyAdd,  ///< a b + c, a b − c, c − a b: made by Program, not recorded
  Sqrt,
  Cbrt,
  Exp,
  Log,
  Acos,
  Abs,
  Atan2,
  Min,
  Max,
  Power,         ///< a to a constant exponent
  WherePositive  ///< b where a > 0, else c
};

/// What was computed from inputs, as a graph without repetitions: an operation on the same values is the same
/// node. Arithmetic with the constants 0 and 1 is left out, so 0 · x is 0, whatever x.
class Recording {
 public:
  using Handle = std::int32_t;  ///< of a node; nodes come after what they are computed from
  struct Node {
    Operation operation;
    std::array<Handle, 3> arguments;  // those not needed are −1
    double value;                     // of a constant, or an exponent
  };

  Handle input();
  Handle constant(double value);
  Handle apply(Operation operation, Handle a, Handle b = -1, Handle c = -1, double value = 0);

  /// ∂output / ∂wrt by the chain rule from the end (reverse mode), as further nodes of this recording. At a kink
  /// the derivative is that of one side. Where `output` is a constant that is not finite, it is NaN.
  std::vector<Handle> gradient(Handle output, std::span<const Handle> wrt);

  Index size() const { return static_cast<Index>(nodes_.size()); }
  const Node& operator[](Handle node) const { return nodes_[node]; }
  bool is_constant(Handle node) const { return nodes_[node].operation == Operation::Constant; }

 private:
  using Key = std::tuple<Operation, std::array<Handle, 3>, std::uint64_t>;  // the value by its bits: NaN equals NaN

  bool is(Handle node, double value) const { return is_constant(node) && nodes_[node].value == value; }
  Handle add(const Node& node);
  Handle simplified(Operation operation, Handle a, Handle b);  // −1 where there is nothing to simplify
  Handle local_derivative(Handle node, int argument, Handle adjoint);

  std::vector<Node> nodes_;
  std::map<Key, Handle> known_;
};

/// A number that writes down what is done to it, in the recording of the innermost RecordingScope of the thread.
class Recorded {
 public:
  Recorded() = default;  // not a value yet
  Recorded(double value) : node_(current().constant(value)) {}
  Recorded(int value) : Recorded(static_cast<double>(value)) {}
  static Recorded of(Recording::Handle node) {
    Recorded result;
    result.node_ = node;
    return result;
  }
  Recording::Handle node() const { return node_; }

  Recorded operator-() const { return record(Operation::Negate, *this); }
  friend Recorded operator+(const Recorded& a, const Recorded& b) { return record(Operation::Add, a, b); }
  friend Recorded operator-(const Recorded& a, const Recorded& b) { return record(Operation::Subtract, a, b); }
  friend Recorded operator*(const Recorded& a, const Recorded& b) { return record(Operation::Multiply, a, b); }
  friend Recorded operator/(const Recorded& a, const Recorded& b) { return record(Operation::Divide, a, b); }
  Recorded& operator+=(const Recorded& b) { return *this = *this + b; }
  Recorded& operator-=(const Recorded& b) { return *this = *this - b; }
  Recorded& operator*=(const Recorded& b) { return *this = *this * b; }
  Recorded& operator/=(const Recorded& b) { return *this = *this / b; }

  friend Recorded sqrt(const Recorded& a) { return record(Operation::Sqrt, a); }
  friend Recorded cbrt(const Recorded& a) { return record(Operation::Cbrt, a); }
  friend Recorded exp(const Recorded& a) { return record(Operation::Exp, a); }
  friend Recorded log(const Recorded& a) { return record(Operation::Log, a); }
  friend Recorded acos(const Recorded& a) { return record(Operation::Acos, a); }
  friend Recorded abs(const Recorded& a) { return record(Operation::Abs, a); }
  friend Recorded atan2(const Recorded& y, const Recorded& x) { return record(Operation::Atan2, y, x); }
  friend Recorded min(const Recorded& a, const Recorded& b) { return record(Operation::Min, a, b); }
  friend Recorded max(const Recorded& a, const Recorded& b) { return record(Operation::Max, a, b); }
  friend Recorded pow(const Recorded& a, double exponent) {
    return of(current().apply(Operation::Power, a.node_, -1, -1, exponent));
  }
  friend Recorded where_positive(const Recorded& a, const Recorded& then, const Recorded& otherwise) {
    return of(current().apply(Operation::WherePositive, a.node_, then.node_, otherwise.node_));
  }

 private:
  friend class RecordingScope;
  static Recording*& innermost();
  static Recording& current() { return *innermost(); }
  static Recorded record(Operation operation, const Recorded& a) { return of(current().apply(operation, a.node_)); }
  static Recorded record(Operation operation, const Recorded& a, const Recorded& b) {
    return of(current().apply(operation, a.node_, b.node_));
  }

  Recording::Handle node_;
};

/// While it lives, this thread's Recorded numbers go to `recording`.
class RecordingScope {
 public:
  explicit RecordingScope(Recording& recording) : outer_(Recorded::innermost()) { Recorded::innermost() = &recording; }
  ~RecordingScope() { Recorded::innermost() = outer_; }
  RecordingScope(const RecordingScope&) = delete;
  RecordingScope& operator=(const RecordingScope&) = delete;

 private:
  Recording* outer_;
};

/// Chosen nodes of a recording, and what they need, as instructions on a few slots.
class Program {
 public:
  static constexpr int max_slots = 512;

  /// \param inputs  in the order of run(). \throws std::invalid_argument if more than max_slots values are alive
  /// at once.
  Program(const Recording& recording, std::span<const Recording::Handle> inputs,
          std::span<const Recording::Handle> outputs);

  Index num_inputs() const { return num_inputs_; }
  Index num_outputs() const { return static_cast<Index>(outputs_.size()); }
  Index num_instructions() const { return static_cast<Index>(instructions_.size()); }

  /// outputs = f(inputs). Real: double or Pack; or Recorded, to go on from a program's values.
  template <typename Real>
  void run(const Real* inputs, Real* outputs) const;

 private:
  using Slot = std::uint16_t;
  struct Instruction {
    Operation operation;
    Slot result, a, b, c;
    double exponent;
  };

  Index num_inputs_;
  std::vector<double> constants_;  // in the slots after the inputs
  std::vector<Instruction> instructions_;
  std::vector<Slot> outputs_;
};

template <typename Real>
void Program::run(const Real* inputs, Real* outputs) const {
  using std::sqrt, std::cbrt, std::exp, std::log, std::acos, std::abs, std::atan2, std::min, std::max, std::pow;
  Real slots[max_slots];
  std::copy_n(inputs, num_inputs_, slots);
  for (std::size_t k = 0; k < constants_.size(); ++k) slots[num_inputs_ + k] = Real(constants_[k]);
  for (const Instruction& i : instructions_) {
    const Real &a = slots[i.a], &b = slots[i.b], &c = slots[i.c];
    Real& result = slots[i.result];
    switch (i.operation) {
      case Operation::Add:
        result = a + b;
        break;
      case Operation::Subtract:
        result = a - b;
        break;
      case Operation::Multiply:
        result = a * b;
        break;
      case Operation::Divide:
        result = a / b;
        break;
      case Operation::Negate:
        result = -a;
        break;
      case Operation::MultiplyAdd:
        result = a * b + c;
        break;
      case Operation::MultiplySubtract:
        result = a * b - c;
        break;
      case Operation::NegateMultiplyAdd:
        result = c - a * b;
        break;
      case Operation::Sqrt:
        result = sqrt(a);
        break;
      case Operation::Cbrt:
        result = cbrt(a);
        break;
      case Operation::Exp:
        result = exp(a);
        break;
      case Operation::Log:
        result = log(a);
        break;
      case Operation::Acos:
        result = acos(a);
        break;
      case Operation::Abs:
        result = abs(a);
        break;
      case Operation::Atan2:
        result = atan2(a, b);
        break;
      case Operation::Min:
        result = min(a, b);
        break;
      case Operation::Max:
        result = max(a, b);
        break;
      case Operation::Power:
        result = pow(a, i.exponent);
        break;
      case Operation::WherePositive:
        result = where_positive(a, b, c);
        break;
      case Operation::Input:
      case Operation::Constant:
        break;
    }
  }
  for (std::size_t k = 0; k < outputs_.size(); ++k) outputs[k] = slots[outputs_[k]];
}

}  // namespace supple

template <>
struct Eigen::NumTraits<supple::Recorded> : supple::RealScalarTraits<supple::Recorded> {};
