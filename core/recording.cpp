#include <core/check.hpp>
#include <core/recording.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <string>
#include <utility>

namespace supple {

Recording*& Recorded::innermost() {
  static thread_local Recording* recording = nullptr;
  return recording;
}

Recording::Handle Recording::add(const Node& node) {
  nodes_.push_back(node);
  return static_cast<Handle>(nodes_.size()) - 1;
}

Recording::Handle Recording::input() {
  return add({Operation::Input, {-1, -1, -1}, 0});
}

Recording::Handle Recording::constant(double value) {
  const Key key{Operation::Constant, {-1, -1, -1}, std::bit_cast<std::uint64_t>(value)};
  const auto [known, is_new] = known_.try_emplace(key, 0);
  if (is_new) known->second = add({Operation::Constant, {-1, -1, -1}, value});
  return known->second;
}

Recording::Handle Recording::apply(Operation operation, Handle a, Handle b, Handle c, double value) {
  const bool commutes = operation == Operation::Add || operation == Operation::Multiply;
  if (commutes && a > b) std::swap(a, b);
  if (const Handle simple = simplified(operation, a, b); simple >= 0) return simple;
  if (operation == Operation::WherePositive && b == c) return b;
  const Key key{operation, {a, b, c}, std::bit_cast<std::uint64_t>(value)};
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  return known_[key] = add({operation, {a, b, c}, value});
}

Recording::Handle Recording::simplified(Operation operation, Handle a, Handle b) {
  const bool both = a >= 0 && b >= 0 && is_constant(a) && is_constant(b);
  const auto negated = [this](Handle node) { return nodes_[node].operation == Operation::Negate; };
  switch (operation) {
    case Operation::Add:
      if (both) return constant(nodes_[a].value + nodes_[b].value);
      if (is(a, 0)) return b;
      if (is(b, 0)) return a;
      if (negated(b)) return apply(Operation::Subtract, a, nodes_[b].arguments[0]);
      if (negated(a)) return apply(Operation::Subtract, b, nodes_[a].arguments[0]);
      return -1;
    case Operation::Subtract:
      if (both) return constant(nodes_[a].value - nodes_[b].value);
      if (is(b, 0)) return a;
      if (is(a, 0)) return apply(Operation::Negate, b);
      if (negated(b)) return apply(Operation::Add, a, nodes_[b].arguments[0]);
      return -1;
    case Operation::Multiply:
      if (both) return constant(nodes_[a].value * nodes_[b].value);
      for (const auto& [x, y] : {std::pair(a, b), std::pair(b, a)}) {
        if (is(x, 0)) return x;
        if (is(x, 1)) return y;
        if (is(x, -1)) return apply(Operation::Negate, y);
        if (negated(x)) return apply(Operation::Negate, apply(Operation::Multiply, nodes_[x].arguments[0], y));
      }
      return -1;
    case Operation::Divide:
      if (is(b, 1)) return a;
      if (is(a, 0)) return a;
      return -1;
    case Operation::Negate:
      if (is_constant(a)) return constant(-nodes_[a].value);
      if (negated(a)) return nodes_[a].arguments[0];
      return -1;
    default:
      return -1;
  }
}

std::vector<Recording::Handle> Recording::gradient(Handle output, std::span<const Handle> wrt) {
  std::vector<Handle> adjoint(output + 1, -1);  // −1: nothing flows there
  adjoint[output] = constant(1);
  for (Handle node = output; node >= 0; --node) {
    if (adjoint[node] < 0 || nodes_[node].operation == Operation::Input || is_constant(node)) continue;
    for (int k = 0; k < 3; ++k) {
      const Handle argument = nodes_[node].arguments[k];
      if (argument < 0 || is_constant(argument)) continue;
      const Handle part = local_derivative(node, k, adjoint[node]);
      if (part < 0) continue;
      adjoint[argument] = adjoint[argument] < 0 ? part : apply(Operation::Add, adjoint[argument], part);
    }
  }
  std::vector<Handle> result;
  for (const Handle input : wrt)
    result.push_back(input <= output && adjoint[input] >= 0 ? adjoint[input] : constant(0));
  return result;
}

/// adjoint · ∂node / ∂argument; −1 if that is zero.
Recording::Handle Recording::local_derivative(Handle node, int argument, Handle adjoint) {
  const auto [operation, arguments, value] = nodes_[node];  // a copy: nodes are added below
  const auto [a, b, c] = arguments;
  const auto times = [&](Handle x) { return apply(Operation::Multiply, adjoint, x); };
  const auto over = [&](Handle x) { return apply(Operation::Divide, adjoint, x); };
  const auto product = [&](Handle x, Handle y) { return apply(Operation::Multiply, x, y); };
  const auto choose = [&](Handle condition, double then, double otherwise) {
    return apply(Operation::WherePositive, condition, constant(then), constant(otherwise));
  };
  switch (operation) {
    case Operation::Add:
      return adjoint;
    case Operation::Subtract:
      return argument == 0 ? adjoint : apply(Operation::Negate, adjoint);
    case Operation::Multiply:
      return times(argument == 0 ? b : a);
    case Operation::Divide:
      return argument == 0 ? over(b) : apply(Operation::Negate, apply(Operation::Divide, times(node), b));
    case Operation::Negate:
      return apply(Operation::Negate, adjoint);
    case Operation::Sqrt:
      return apply(Operation::Divide, times(constant(0.5)), node);
    case Operation::Cbrt:
      return apply(Operation::Divide, times(node), product(constant(3), a));
    case Operation::Exp:
      return times(node);
    case Operation::Log:
      return over(a);
    case Operation::Acos: {
      const Handle sine = apply(Operation::Sqrt, apply(Operation::Subtract, constant(1), product(a, a)));
      return apply(Operation::Negate, over(sine));
    }
    case Operation::Abs:
      return times(choose(a, 1, -1));
    case Operation::Atan2: {  // of y = a, x = b
      const Handle square = apply(Operation::Add, product(a, a), product(b, b));
      const Handle part = apply(Operation::Divide, times(argument == 0 ? b : a), square);
      return argument == 0 ? part : apply(Operation::Negate, part);
    }
    case Operation::Min:
    case Operation::Max: {
      const Handle larger = apply(Operation::Subtract, a, b);
      const bool here = (operation == Operation::Max) == (argument == 0);
      return times(choose(larger, here ? 1 : 0, here ? 0 : 1));
    }
    case Operation::Power:
      return times(product(constant(value), apply(Operation::Power, a, -1, -1, value - 1)));
    case Operation::WherePositive: {
      if (argument == 0) return -1;
      const Handle other = argument == 1 ? c : b;
      const bool undefined = is_constant(other) && !std::isfinite(nodes_[other].value);
      const Handle there = constant(undefined ? std::numeric_limits<double>::quiet_NaN() : 0.0);
      return argument == 1 ? apply(Operation::WherePositive, a, adjoint, there)
                           : apply(Operation::WherePositive, a, there, adjoint);
    }
    default:
      return -1;
  }
}

Program::Program(const Recording& recording, std::span<const Recording::Handle> inputs,
                 std::span<const Recording::Handle> outputs)
    : num_inputs_(static_cast<Index>(inputs.size())) {
  using Handle = Recording::Handle;
  const Index n = recording.size();
  std::vector<Recording::Node> nodes;
  for (Handle k = 0; k < n; ++k) nodes.push_back(recording[k]);

  // what is needed, and how often
  std::vector<int> uses(n, 0);
  for (const Handle output : outputs) ++uses[output];
  for (Handle k = static_cast<Handle>(n) - 1; k >= 0; --k)
    if (uses[k] > 0)
      for (const Handle argument : nodes[k].arguments)
        if (argument >= 0) ++uses[argument];

  // a product that only one sum needs becomes a part of it
  for (Handle k = 0; k < n; ++k) {
    Recording::Node& node = nodes[k];
    if (uses[k] == 0 || (node.operation != Operation::Add && node.operation != Operation::Subtract)) continue;
    const auto [x, y, none] = node.arguments;
    const auto absorb = [&](Handle factor, Handle other, Operation operation) {
      if (nodes[factor].operation != Operation::Multiply || uses[factor] != 1) return false;
      uses[factor] = 0;
      node = {operation, {nodes[factor].arguments[0], nodes[factor].arguments[1], other}, 0};
      return true;
    };
    const bool sum = node.operation == Operation::Add;
    if (!absorb(y, x, sum ? Operation::MultiplyAdd : Operation::NegateMultiplyAdd))
      absorb(x, y, sum ? Operation::MultiplyAdd : Operation::MultiplySubtract);
  }

  std::vector<Handle> last_use(n, -1);
  for (Handle k = 0; k < n; ++k)
    if (uses[k] > 0)
      for (const Handle argument : nodes[k].arguments)
        if (argument >= 0) last_use[argument] = k;
  for (const Handle output : outputs) last_use[output] = static_cast<Handle>(n);

  std::vector<int> slot_of(n, -1);
  int count = 0;
  for (const Handle input : inputs) slot_of[input] = count++;
  for (Handle k = 0; k < n; ++k)
    if (uses[k] > 0 && nodes[k].operation == Operation::Constant) {
      constants_.push_back(nodes[k].value);
      slot_of[k] = count++;
    }
  std::vector<int> free_slots;
  for (Handle k = 0; k < n; ++k) {
    const auto& [operation, arguments, value] = nodes[k];
    if (uses[k] == 0 || operation == Operation::Constant || operation == Operation::Input) continue;
    std::array<Slot, 3> from{};
    for (int i = 0; i < 3; ++i)
      if (arguments[i] >= 0) from[i] = static_cast<Slot>(slot_of[arguments[i]]);
    if (free_slots.empty()) free_slots.push_back(count++);
    const int to = free_slots.back();
    free_slots.pop_back();
    for (int i = 0; i < 3; ++i) {
      const Handle x = arguments[i];
      const bool repeated = std::find(arguments.begin(), arguments.begin() + i, x) != arguments.begin() + i;
      const bool temporary =
          x >= 0 && nodes[x].operation != Operation::Constant && nodes[x].operation != Operation::Input;
      if (temporary && last_use[x] == k && !repeated) free_slots.push_back(slot_of[x]);
    }
    slot_of[k] = to;
    instructions_.push_back({operation, static_cast<Slot>(to), from[0], from[1], from[2], value});
  }
  require(count <= max_slots, "a recorded formula keeps " + std::to_string(count) +
                                  " values at once, expected at most " + std::to_string(max_slots));
  for (const Handle output : outputs) outputs_.push_back(static_cast<Slot>(slot_of[output]));
}

}  // namespace supple
