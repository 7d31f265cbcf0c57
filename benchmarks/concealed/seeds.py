"""The seeds that cases are drawn from: a set to develop with, and sets for reports."""

SEED_SETS = {
    "dev": 20_260,
    "final": 71_077,
    "final_2": 82_411,
    "final_3": 93_607,
    "final_4": 104_729,
    "final_5": 115_249,
    "final_6": 126_851,
    "final_7": 148_517,
    "final_8": 543_601,
    "final_9": 611_953,
    "final_10": 734_827,
    "final_11": 861_433,
    "final_12": 927_587,
    "final_13": 1_039_223,
    "final_14": 1_187_561,
    "final_15": 1_254_889,
    "final_16": 1_361_407,
    "final_17": 1_452_821,
}
"""Final ones are opened once: `final` in the first report, `final_2` in the second,
`final_3` in the third, `final_4` in the fourth, `final_5` in the fifth, and so on.
"""
