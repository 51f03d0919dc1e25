"""The tables, trees and lines that the pages of the inspector are made of."""
