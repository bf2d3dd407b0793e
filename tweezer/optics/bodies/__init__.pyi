from .shapes import t_matrix
from .t_matrix import TMatrix

__all__ = ["TMatrix", "t_matrix"]
