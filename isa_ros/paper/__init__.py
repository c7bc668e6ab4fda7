"""The paper's tables and statements as data, each number with its place in the paper."""
