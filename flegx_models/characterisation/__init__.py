"""Chapter 3 of the thesis as functions: from bench measurements to model parameters.

Each file holds one idea and no number of the machine; the printed values are in
`flegx_models.parameters_chapter3`. Where the thesis's formula is wrong or only
approximate, the function computes what is right and the docstring says what is
printed. SI units throughout.
"""
