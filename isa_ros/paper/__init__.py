"""The paper's tables and statements as data, each number with the place it is printed at."""
