#pragma once
#include "search/cma_es/cma_es.hpp"
#include "search/cma_es/lq_model.hpp"

namespace treacle::search {

// CMA-ES that measures only as many candidates of a generation as it takes for a linear or quadratic model to rank the
// newest values right (Hansen 2019, lq-CMA-ES); the others have the model's values. The least place of the model is a candidate of
// the next generation. Many times fewer evaluations where the objective is near to quadratic.
class LqCmaEs : public CmaEs {
public:
    explicit LqCmaEs(std::vector<Axis> axes, CmaOptions options = {});

    // Every requested value is needed.
    double cut(std::size_t) const override { return std::numeric_limits<double>::infinity(); }
    // Candidates of this generation that are measured should the model not suffice.
    std::vector<Point> speculate() const override { return next_; }
    const char* name() const override { return "lq-cma-es"; }

protected:
    Task<std::vector<Value>> values_of(const std::vector<std::vector<double>>& candidates) override;
    std::optional<std::vector<double>> suggestion() const override;
    void forget() override;

private:
    using Candidates = std::vector<std::vector<double>>;
    std::vector<std::size_t> unmeasured_by_model(const Candidates& candidates, const std::vector<bool>& measured) const;
    std::vector<Value> with_model(const Candidates& candidates, const std::vector<std::optional<Value>>& values) const;

    LqModel model_;
    std::vector<Point> next_;
};

} // namespace treacle::search
