//! Monomials of the variables of a box, numbered as they appear.
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

/// Largest number of variables: four bits of a key each.
pub(crate) const MAX_VARIABLES: usize = 16;
/// Largest total degree: that of one variable fits four bits.
pub(crate) const MAX_DEGREE: u32 = 12;

/// Numbers monomials up to a total degree and remembers their products.
///
/// Every variable lies in [−1, 1]. Monomial 0 is the constant 1.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    tables: Arc<Tables>,
    /// Sums by monomial, 0 between two uses.
    scratch: Vec<f64>,
    is_touched: Vec<bool>,
    touched: Vec<u32>,
}

/// Monomials and their products, shared by the bases of equal boxes until one needs more.
#[derive(Clone, Debug)]
struct Tables {
    degree: u32,
    keys: Vec<u64>,
    index: HashMap<u64, u32>,
    products: Vec<Vec<u32>>,
}

/// Tables by number of variables and degree, with all their monomials.
static COMPLETE: Mutex<BTreeMap<(usize, u32), Arc<Tables>>> = Mutex::new(BTreeMap::new());

/// A product that hasn't been looked up.
const UNKNOWN: u32 = u32::MAX;
/// A product beyond the degree with an odd exponent, in [−1, 1].
pub(crate) const BEYOND_ODD: u32 = u32::MAX - 1;
/// A product beyond the degree with even exponents only, in [0, 1].
pub(crate) const BEYOND_EVEN: u32 = u32::MAX - 2;

const ODD_BITS: u64 = 0x1111_1111_1111_1111;

impl Basis {
    /// Returns the basis of some variables up to a degree; others may join.
    pub(crate) fn new(variables: usize, degree: u32) -> Self {
        let degree = degree.min(MAX_DEGREE);
        let mut complete = COMPLETE.lock().unwrap_or_else(PoisonError::into_inner);
        let tables =
            complete.entry((variables, degree)).or_insert_with(|| Arc::new(Tables::new(variables, degree)));
        let tables = Arc::clone(tables);
        let count = tables.keys.len();
        Self { tables, scratch: vec![0.0; count], is_touched: vec![false; count], touched: Vec::new() }
    }

    pub(crate) fn degree(&self) -> u32 {
        self.tables.degree
    }

    /// Returns the monomial that is one variable.
    pub(crate) fn variable(&mut self, variable: usize) -> u32 {
        let key = 1 << (4 * variable);
        match self.tables.index.get(&key) {
            Some(known) => *known,
            None => Arc::make_mut(&mut self.tables).intern(key),
        }
    }

    /// Returns true for the monomial that is one variable.
    pub(crate) fn is_variable(&self, monomial: u32, variable: usize) -> bool {
        self.tables.keys[monomial as usize] == 1 << (4 * variable)
    }

    /// Returns the exponent of a variable in a monomial.
    pub(crate) fn exponent(&self, monomial: u32, variable: usize) -> u32 {
        (self.tables.keys[monomial as usize] >> (4 * variable) & 15) as u32
    }

    /// Returns true for a monomial with even exponents only: it lies in [0, 1].
    pub(crate) fn is_even(&self, monomial: u32) -> bool {
        self.tables.keys[monomial as usize] & ODD_BITS == 0
    }

    /// Returns the product of two monomials, or which kind beyond the degree it is.
    #[inline]
    pub(crate) fn product(&mut self, a: u32, b: u32) -> u32 {
        match self.tables.products[a as usize].get(b as usize) {
            Some(&known) if known != UNKNOWN => known,
            _ => Arc::make_mut(&mut self.tables).find_product(a, b),
        }
    }

    /// Adds to the sum of a monomial.
    #[inline]
    pub(crate) fn accumulate(&mut self, monomial: u32, value: f64) {
        let place = monomial as usize;
        if place >= self.scratch.len() {
            self.scratch.resize(place + 1, 0.0);
            self.is_touched.resize(place + 1, false);
        }
        self.scratch[place] += value;
        if !self.is_touched[place] {
            self.is_touched[place] = true;
            self.touched.push(monomial);
        }
    }

    /// Takes the sums, in the order of their monomials, and clears them.
    pub(crate) fn take_sums(&mut self) -> Vec<(u32, f64)> {
        self.touched.sort_unstable();
        let (scratch, is_touched) = (&mut self.scratch, &mut self.is_touched);
        let mut terms = Vec::with_capacity(self.touched.len());
        for monomial in self.touched.drain(..) {
            let place = monomial as usize;
            let sum = std::mem::take(&mut scratch[place]);
            is_touched[place] = false;
            if sum != 0.0 {
                terms.push((monomial, sum));
            }
        }
        terms
    }
}

impl Tables {
    /// Returns the tables of all monomials of some variables up to a degree.
    fn new(variables: usize, degree: u32) -> Self {
        let mut tables = Self { degree, keys: Vec::new(), index: HashMap::new(), products: Vec::new() };
        tables.intern(0);
        for variable in (0..variables).filter(|_| degree > 0) {
            tables.intern(1 << (4 * variable));
        }
        // A monomial × a variable is a monomial of the next degree.
        let mut next = 0;
        while next < tables.keys.len() {
            for variable in 0..variables.min(tables.keys.len() - 1) {
                tables.find_product(next as u32, variable as u32 + 1);
            }
            next += 1;
        }
        for a in 0..tables.keys.len() as u32 {
            for b in 0..tables.keys.len() as u32 {
                tables.find_product(a, b);
            }
        }
        tables
    }

    #[cold]
    fn find_product(&mut self, a: u32, b: u32) -> u32 {
        let (left, right) = (self.keys[a as usize], self.keys[b as usize]);
        let product = if total_degree(left) + total_degree(right) <= self.degree {
            self.intern(left + right)
        } else if (left ^ right) & ODD_BITS == 0 {
            BEYOND_EVEN
        } else {
            BEYOND_ODD
        };
        let row = &mut self.products[a as usize];
        if row.len() <= b as usize {
            row.resize(b as usize + 1, UNKNOWN);
        }
        row[b as usize] = product;
        product
    }

    fn intern(&mut self, key: u64) -> u32 {
        if let Some(&known) = self.index.get(&key) {
            return known;
        }
        let monomial = self.keys.len() as u32;
        self.keys.push(key);
        self.index.insert(key, monomial);
        self.products.push(Vec::new());
        monomial
    }
}

/// Returns the sum of the exponents of a key.
fn total_degree(key: u64) -> u32 {
    (0..MAX_VARIABLES).map(|variable| (key >> (4 * variable) & 15) as u32).sum()
}
