#pragma once
#include <filesystem>
#include <memory>
#include <string>

namespace treacle {

struct DocumentTree; // private to base

// A YAML file, read but not interpreted: blocks, lists and words, each with its place.
class Document {
public:
    // Throw InputError when the file cannot be read or is not YAML. Duplicate keys are found here and
    // reported with everything else by parse().
    static Document load(const std::filesystem::path& path);
    static Document from_text(const std::string& text, const std::string& name);

    // Copies are deep. A document that was moved from has no tree.
    Document(const Document& other);
    Document(Document&& other) noexcept;
    Document& operator=(Document other) noexcept;
    ~Document();

    // Applies "a.b.c=value" before parsing; an item of a list is named by its number or its `name`.
    // Missing blocks are made. What does not fit is reported by parse(), at `origin`, or at "--set a.b.c=value".
    void set(const std::string& assignment, const std::string& origin = "");

    const DocumentTree& tree() const { return *tree_; } // changed by set(), gone after an assignment

private:
    explicit Document(std::unique_ptr<DocumentTree> tree);
    std::unique_ptr<DocumentTree> tree_;
};

} // namespace treacle
