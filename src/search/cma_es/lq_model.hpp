#pragma once
#include <cstddef>
#include <optional>
#include <vector>

namespace treacle::search {

// A polynomial through the newest measured values by weighted least squares: linear, then with squares, then with products as
// values suffice (Hansen 2019, section 3). Better values weigh more, the worst quarter nothing.
class LqModel {
public:
    explicit LqModel(std::size_t dimensions, std::size_t population);

    // x: [n]. A measured value: bounds and failures have no place in the fit. The model changes with the next `fit`.
    void add(const std::vector<double>& x, double value);
    // Puts the newest in the order of their values, the best first, and fits.
    void fit(std::size_t newest);
    double at(const std::vector<double>& x) const;
    // Minimiser of the model; none where it is not bounded below, or there is none yet.
    std::optional<std::vector<double>> minimum() const;
    // Slope of the model at a point, [n] value per coordinate.
    std::vector<double> gradient(const std::vector<double>& x) const;
    // Kendall's rank correlation of model and values over the newest; 0 below three.
    double agreement(std::size_t newest) const;
    std::size_t size() const { return entries_.size(); }

private:
    enum class Terms { linear, squares, products };
    struct Entry {
        std::vector<double> x;
        double value = 0;
    };
    std::size_t coefficients(Terms terms) const;
    Terms terms() const; // that the values suffice for
    std::vector<double> expanded(const std::vector<double>& x, Terms terms) const;

    std::size_t dimensions_, population_;
    std::vector<Entry> entries_; // the newest first
    Terms fitted_ = Terms::linear;
    std::vector<double> origin_; // the best place: squares of distances from it keep their digits
    std::vector<double> solution_;
};

} // namespace treacle::search
